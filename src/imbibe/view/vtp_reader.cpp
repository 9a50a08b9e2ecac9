#include "imbibe/view/vtp_reader.h"

#include <charconv>
#include <cstring>
#include <optional>
#include <string_view>

#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"

namespace imbibe {

namespace {

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path), content_(read_whole_file(path)) {
    const std::string_view mark = "<AppendedData encoding=\"raw\">";
    const std::size_t at = content_.find(mark);
    if (at == std::string::npos) fail("has no raw appended data");
    head_ = std::string_view(content_).substr(0, at);
    const std::size_t underscore = content_.find('_', at + mark.size());
    if (underscore == std::string::npos) fail("has no appended data");
    data_ = std::string_view(content_).substr(underscore + 1);
    if (head_.find("byte_order=\"LittleEndian\"") == std::string_view::npos ||
        head_.find("header_type=\"UInt64\"") == std::string_view::npos)
      fail("is not little endian with 64-bit headers");
  }

  [[noreturn]] void fail(const std::string& what) const { throw InputError(path_.string() + ": the file " + what); }

  std::size_t number(std::string_view element, const std::string& attribute) const {
    const std::string_view text = word(element, attribute);
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) fail("has no whole number in " + attribute);
    return value;
  }

  std::string_view word(std::string_view element, const std::string& attribute) const {
    const std::string mark = " " + attribute + "=\"";
    const std::size_t at = element.find(mark);
    if (at == std::string_view::npos) fail("lacks " + attribute);
    const std::size_t end = element.find('"', at + mark.size());
    if (end == std::string_view::npos) fail("is cut short");
    return element.substr(at + mark.size(), end - at - mark.size());
  }

  // The start tags of the given kind within [from, to) of the head.
  std::vector<std::string_view> tags(std::string_view within, const std::string& kind) const {
    std::vector<std::string_view> found;
    const std::string mark = "<" + kind + " ";
    for (std::size_t at = 0; (at = within.find(mark, at)) != std::string_view::npos;) {
      const std::size_t end = within.find('>', at);
      if (end == std::string_view::npos) fail("is cut short");
      found.push_back(within.substr(at, end - at));
      at = end;
    }
    return found;
  }

  std::string_view section(const std::string& name) const {
    const std::size_t from = head_.find("<" + name + ">"), to = head_.find("</" + name + ">");
    return from == std::string_view::npos || to == std::string_view::npos || to < from ? std::string_view{}
                                                                                       : head_.substr(from, to - from);
  }

  template <class T>
  std::vector<T> values(std::string_view element, std::size_t count) const {
    const std::size_t offset = number(element, "offset");
    std::uint64_t bytes = 0;
    if (offset > data_.size() || data_.size() - offset < sizeof bytes) fail("is cut short");
    std::memcpy(&bytes, data_.data() + offset, sizeof bytes);
    if (bytes > data_.size() - offset - sizeof bytes) fail("is cut short");
    if (bytes / sizeof(T) != count || bytes % sizeof(T) != 0)
      fail("has another number of values than of points in " + std::string(word(element, "Name")));
    std::vector<T> result(count);
    if (count > 0) std::memcpy(result.data(), data_.data() + offset + sizeof bytes, bytes);
    return result;
  }

  std::string_view head() const { return head_; }

 private:
  std::filesystem::path path_;
  std::string content_;
  std::string_view head_, data_;
};

}  // namespace

PolyData read_vtp(const std::filesystem::path& path) {
  const Reader reader(path);
  const auto pieces = reader.tags(reader.head(), "Piece");
  if (pieces.size() != 1) reader.fail("does not have one piece");
  // Larger than the file itself: a damaged count, found before memory is taken for it.
  const std::size_t count = reader.number(pieces[0], "NumberOfPoints"), lines = reader.number(pieces[0], "NumberOfLines");
  const auto point_tags = reader.tags(reader.section("Points"), "DataArray");
  if (point_tags.size() != 1) reader.fail("does not have one array of points");

  PolyData data;
  const std::vector<float> flat = reader.values<float>(point_tags[0], 3 * count);
  data.points.resize(count);
  for (std::size_t i = 0; i < count; ++i) data.points[i] = {flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]};
  if (lines > 0) {
    for (const std::string_view tag : reader.tags(reader.section("Lines"), "DataArray")) {
      if (reader.word(tag, "Name") != "offsets") continue;
      data.line_start = reader.values<std::int32_t>(tag, lines);
      data.line_start.insert(data.line_start.begin(), 0);
    }
    for (std::size_t i = 1; i < data.line_start.size(); ++i)
      if (data.line_start[i] < data.line_start[i - 1]) reader.fail("has lines out of order");
    if (data.line_start.empty() || static_cast<std::size_t>(data.line_start.back()) != count)
      reader.fail("has lines that do not end with the points");
  }
  for (const std::string_view tag : reader.tags(reader.section("PointData"), "DataArray")) {
    const std::string name(reader.word(tag, "Name"));
    const std::size_t components = reader.number(tag, "NumberOfComponents");
    if (components < 1 || components > 9) reader.fail("has an odd number of components in " + name);
    if (reader.word(tag, "type") == "Float32") {
      data.add(name, reader.values<float>(tag, components * count), static_cast<int>(components));
    } else if (reader.word(tag, "type") == "Int32") {
      data.add(name, reader.values<std::int32_t>(tag, components * count), static_cast<int>(components));
    } else {
      reader.fail("has an array of another type: " + name);
    }
  }
  return data;
}

const std::vector<float>* find_floats(const PolyData& data, const std::string& name) {
  for (const PointArray& array : data.arrays)
    if (array.name == name && array.components == 1) return std::get_if<std::vector<float>>(&array.values);
  return nullptr;
}

}  // namespace imbibe
