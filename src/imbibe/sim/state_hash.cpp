#include "imbibe/sim/state_hash.h"

#include <fmt/format.h>

#include <cstring>
#include <type_traits>

#include "imbibe/core/random.h"
#include "imbibe/sim/state_fields.h"

namespace imbibe {

namespace {

class HashVisitor {
 public:
  void group(const std::string& name) { bytes(name.data(), name.size()); }

  template <class T>
  void value(const char*, const T& x) {
    one(x);
  }

  template <class T>
  void array(const char*, const std::vector<T>& x) {
    word(x.size());
    if constexpr (std::is_arithmetic_v<T>) {
      bytes(x.data(), x.size() * sizeof(T));
    } else {
      for (const T& item : x) one(item);
    }
  }

  std::uint64_t result() const { return state_; }

 private:
  void word(std::uint64_t w) { state_ = mixed(state_ ^ w); }

  // Eight bytes at a time; the last, shorter piece is filled with zeros.
  void bytes(const void* data, std::size_t count) {
    const char* from = static_cast<const char*>(data);
    for (; count > 0;) {
      const std::size_t piece = count < 8 ? count : 8;
      std::uint64_t w = 0;
      std::memcpy(&w, from, piece);
      word(w);
      from += piece;
      count -= piece;
    }
  }

  template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void one(const T& x) {
    bytes(&x, sizeof x);
  }
  void one(const Vec3& p) { one(p.x), one(p.y), one(p.z); }
  void one(const Float4& p) { one(p.x), one(p.y), one(p.z); }  // w is scratch of the solver

  std::uint64_t state_ = 0x696d62696265ULL;
};

}  // namespace

std::uint64_t state_hash(const World& world) {
  HashVisitor visitor;
  visit_state(visitor, world);
  return visitor.result();
}

std::string state_hash_text(const World& world) { return fmt::format("{:016x}", state_hash(world)); }

}  // namespace imbibe
