#include "imbibe/sim/checkpoint.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"
#include "imbibe/core/random.h"
#include "imbibe/sim/state_check.h"
#include "imbibe/sim/state_fields.h"
#include "imbibe/sim/state_hash.h"

namespace imbibe {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t user_block_bytes = 512;  // the smallest that HDF5 looks behind for its own signature
constexpr const char* user_block_form = "imbibe checkpoint\nversion %d\nbytes %llu\nchecksum %llx\n";

// An identifier of the HDF5 library, given back at the end of its scope.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }
  bool good() const { return id_ >= 0; }

 private:
  hid_t id_;
  Close close_;
};

// The library prints its errors unless told otherwise; what goes wrong here becomes an exception instead.
class QuietHdf5 {
 public:
  QuietHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

// How a type of the state lies in a file: numbers of one kind, `columns` per item.
template <class T>
struct Stored {
  static constexpr hsize_t columns = 1;
  using Number = T;
};
template <>
struct Stored<Vec3> {
  static constexpr hsize_t columns = 3;
  using Number = Real;
};
template <>
struct Stored<Float4> {
  static constexpr hsize_t columns = 4;
  using Number = float;
};
template <>
struct Stored<bool> {
  static constexpr hsize_t columns = 1;
  using Number = std::uint8_t;
};
template <>
struct Stored<ParticleClass> {
  static constexpr hsize_t columns = 1;
  using Number = std::uint8_t;
};

template <class Number>
hid_t number_type() {
  if constexpr (std::is_same_v<Number, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<Number, float>) return H5T_NATIVE_FLOAT;
  if constexpr (std::is_same_v<Number, std::uint8_t>) return H5T_NATIVE_UINT8;
  if constexpr (std::is_same_v<Number, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<Number, std::uint32_t>) return H5T_NATIVE_UINT32;
  if constexpr (std::is_same_v<Number, std::uint64_t>) return H5T_NATIVE_UINT64;
}

// In memory there is nothing that the disk could refuse: a failure is our bug.
void require(bool good) { IMBIBE_ASSERT(good); }

class WriteVisitor {
 public:
  explicit WriteVisitor(hid_t file) : file_(file), create_groups_(H5Pcreate(H5P_LINK_CREATE), H5Pclose) {
    require(H5Pset_create_intermediate_group(create_groups_, 1) >= 0);
  }

  void group(const std::string& name) { path_ = name + "/"; }

  template <class T>
  void value(const char* name, const T& x) {
    write(name, &x, 1, true);
  }

  template <class T>
  void array(const char* name, const std::vector<T>& x) {
    write(name, x.data(), x.size(), false);
  }

 private:
  template <class T>
  void write(const char* name, const T* data, hsize_t count, bool single) {
    using S = Stored<T>;
    static_assert(sizeof(T) == S::columns * sizeof(typename S::Number));
    const hid_t type = number_type<typename S::Number>();
    const std::array<hsize_t, 2> size{count, S::columns};
    const int dimensions = S::columns > 1 ? 2 : 1;
    const Handle space(single && S::columns == 1 ? H5Screate(H5S_SCALAR)
                                                 : H5Screate_simple(dimensions, size.data(), nullptr),
                       H5Sclose);
    const Handle set(H5Dcreate2(file_, (path_ + name).c_str(), type, space, create_groups_, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
    require(space.good() && set.good());
    if (count > 0) require(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
  }

  hid_t file_;
  Handle create_groups_;
  std::string path_;
};

class ReadVisitor {
 public:
  explicit ReadVisitor(hid_t file) : file_(file) {}

  void group(const std::string& name) { path_ = name + "/"; }

  void value(const char* name, bool& x) {
    std::uint8_t number = 0;
    value(name, number);
    x = number != 0;
  }

  template <class T>
  void value(const char* name, T& x) {
    std::vector<T> one;
    array(name, one);
    if (one.size() == 1) {
      x = one[0];
    } else if (problems_.empty()) {
      problems_.push_back(fmt::format("field {}{} has {} values instead of 1", path_, name, one.size()));
    }
  }

  template <class T>
  void array(const char* name, std::vector<T>& x) {
    using S = Stored<T>;
    const Handle set(H5Dopen2(file_, (path_ + name).c_str(), H5P_DEFAULT), H5Dclose);
    if (!set.good()) {
      problems_.push_back(fmt::format("has no field {}{}: written by another version of Imbibe", path_, name));
      return;
    }
    const Handle space(H5Dget_space(set), H5Sclose);
    const hssize_t numbers = H5Sget_simple_extent_npoints(space);
    if (numbers < 0 || static_cast<hsize_t>(numbers) % S::columns != 0) {
      problems_.push_back(fmt::format("field {}{} has {} numbers, {} per item are wanted", path_, name, numbers,
                                      S::columns));
      return;
    }
    x.assign(static_cast<std::size_t>(numbers) / S::columns, T{});
    if (numbers > 0 &&
        H5Dread(set, number_type<typename S::Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, x.data()) < 0) {
      problems_.push_back(fmt::format("field {}{} cannot be read", path_, name));
    }
  }

  const std::vector<std::string>& problems() const { return problems_; }

 private:
  hid_t file_;
  std::string path_;
  std::vector<std::string> problems_;
};

void write_attribute(hid_t file, const char* name, std::uint64_t value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(file, name, H5T_NATIVE_UINT64, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require(attribute.good() && H5Awrite(attribute, H5T_NATIVE_UINT64, &value) >= 0);
}

std::uint64_t read_attribute(hid_t file, const char* name) {
  std::uint64_t value = 0;
  const Handle attribute(H5Aopen(file, name, H5P_DEFAULT), H5Aclose);
  if (attribute.good()) H5Aread(attribute, H5T_NATIVE_UINT64, &value);
  return value;
}

// Files live in memory only; the bytes go to and from the disk by our own hand. HDF5 on a disk that fills up leaves
// its own library in a state that fails again at exit.
Handle in_memory_access() {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  require(access >= 0 && H5Pset_fapl_core(access, std::size_t{1} << 20, false) >= 0);
  return {access, H5Pclose};
}

std::vector<char> hdf5_image(const World& world) {
  const QuietHdf5 quiet;
  const Handle access = in_memory_access();
  const Handle file(H5Fcreate("imbibe_checkpoint", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose);
  require(file.good());
  WriteVisitor visitor(file);
  visit_state(visitor, world);
  write_attribute(file, "version", checkpoint_version);
  write_attribute(file, "state_hash", state_hash(world));
  write_attribute(file, "textiles", world.textiles.size());
  write_attribute(file, "sources", world.sources.size());
  require(H5Fflush(file, H5F_SCOPE_LOCAL) >= 0);
  const ssize_t bytes = H5Fget_file_image(file, nullptr, 0);
  require(bytes > 0);
  std::vector<char> image(static_cast<std::size_t>(bytes));
  require(H5Fget_file_image(file, image.data(), image.size()) == bytes);
  return image;
}

std::uint64_t checksum(const char* data, std::size_t bytes) {
  std::uint64_t sum = mixed(bytes);
  for (std::size_t at = 0; at < bytes; at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, data + at, std::min<std::size_t>(8, bytes - at));
    sum = mixed(sum ^ word);
  }
  return sum;
}

[[noreturn]] void refuse(const fs::path& path, const std::vector<std::string>& reasons) {
  std::vector<Problem> problems;
  for (const std::string& reason : reasons) problems.push_back({path.string(), 0, 0, "", reason});
  throw InputError(std::move(problems));
}

// The HDF5 part of a checkpoint file, its checksum verified.
std::string_view verified_image(const fs::path& path, const std::string& content) {
  if (content.size() <= user_block_bytes || !content.starts_with("imbibe checkpoint\n")) {
    refuse(path, {"is not a checkpoint of Imbibe"});
  }
  int version = 0;
  unsigned long long bytes = 0, sum = 0;
  const std::string head = content.substr(0, user_block_bytes);
  if (std::sscanf(head.c_str(), user_block_form, &version, &bytes, &sum) != 3) {
    refuse(path, {"checkpoint is damaged: its head cannot be read"});
  }
  if (version != checkpoint_version) {
    refuse(path, {fmt::format("is of checkpoint format {}, this program reads {}", version, checkpoint_version)});
  }
  const std::string_view image = std::string_view(content).substr(user_block_bytes);
  if (image.size() != bytes) {
    refuse(path, {fmt::format("checkpoint is damaged: {} bytes where {} were written", image.size(), bytes)});
  }
  if (checksum(image.data(), image.size()) != sum) refuse(path, {"checkpoint is damaged: its checksum does not agree"});
  return image;
}

}  // namespace

void write_checkpoint(const fs::path& path, const World& world) {
  const std::vector<char> image = hdf5_image(world);
  std::array<char, user_block_bytes> head{};
  std::snprintf(head.data(), head.size(), user_block_form, checkpoint_version,
                static_cast<unsigned long long>(image.size()),
                static_cast<unsigned long long>(checksum(image.data(), image.size())));
  OutputFile file(path);
  file.write(head.data(), head.size());
  file.write(image.data(), image.size());
  file.commit(true);
}

void read_checkpoint(const fs::path& path, World& built) {
  const std::string content = read_whole_file(path);
  const std::string_view image = verified_image(path, content);

  const QuietHdf5 quiet;
  const Handle access = in_memory_access();
  // The library copies the image; it does not write to it.
  if (H5Pset_file_image(access, const_cast<char*>(image.data()), image.size()) < 0) {
    refuse(path, {"checkpoint does not fit in memory"});
  }
  const Handle file(H5Fopen("imbibe_checkpoint", H5F_ACC_RDONLY, access), H5Fclose);
  if (!file.good()) refuse(path, {"checkpoint is damaged: not an HDF5 file"});

  std::vector<std::string> problems;
  const auto count = [&](const char* what, std::size_t wanted) {
    const std::uint64_t stored = read_attribute(file, what);
    if (stored == wanted) return;
    problems.push_back(fmt::format("is of another scene: {} {}, the scene has {}", stored, what, wanted));
  };
  count("textiles", built.textiles.size());
  count("sources", built.sources.size());
  if (!problems.empty()) refuse(path, problems);

  World read = built;
  ReadVisitor visitor(file);
  visit_state(visitor, read);
  if (!visitor.problems().empty()) refuse(path, visitor.problems());
  problems = unsound_state(read, built);
  if (!problems.empty()) refuse(path, problems);
  if (state_hash(read) != read_attribute(file, "state_hash")) {
    refuse(path, {"checkpoint is damaged: the state read is not the state written"});
  }
  built = std::move(read);
}

std::vector<fs::path> list_checkpoints(const fs::path& folder) {
  std::vector<std::pair<unsigned long long, fs::path>> found;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    unsigned long long step = 0;
    int end = 0;
    if (std::sscanf(name.c_str(), "checkpoint_%llu.h5%n", &step, &end) == 1 && end == static_cast<int>(name.size())) {
      found.emplace_back(step, entry.path());
    }
  }
  std::sort(found.begin(), found.end());
  std::vector<fs::path> paths;
  for (auto& [step, path] : found) paths.push_back(std::move(path));
  return paths;
}

fs::path save_checkpoint(const fs::path& folder, const World& world, int keep) {
  const fs::path path = folder / fmt::format("checkpoint_{:09}.h5", world.step);
  write_checkpoint(path, world);
  // The older ones go only now that the new one is safe; this one stays whatever steps the others claim.
  std::vector<fs::path> others = list_checkpoints(folder);
  std::erase(others, path);
  for (std::size_t i = 0; i + static_cast<std::size_t>(std::max(1, keep)) <= others.size(); ++i) {
    std::error_code ignored;
    fs::remove(others[i], ignored);
  }
  return path;
}

std::optional<fs::path> read_newest_checkpoint(const fs::path& folder, World& built,
                                               std::vector<std::string>* passed_over) {
  std::vector<fs::path> paths = list_checkpoints(folder);
  std::vector<Problem> problems;
  for (; !paths.empty(); paths.pop_back()) {
    try {
      read_checkpoint(paths.back(), built);
      return paths.back();
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
      if (passed_over) passed_over->push_back(error.what());
    }
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  return std::nullopt;
}

}  // namespace imbibe
