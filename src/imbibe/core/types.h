// Scalars, vectors and constants shared by every layer. SI units; z is up.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

namespace imbibe {

using Real = double;
using Index = std::uint32_t;
inline constexpr Index no_index = std::numeric_limits<Index>::max();
inline constexpr Real pi = std::numbers::pi_v<Real>;

// A vector of three components. Plain and trivially copyable; component access by name only.
template <class T>
struct Vector3 {
  T x{}, y{}, z{};

  constexpr Vector3() = default;
  constexpr Vector3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  template <class U>
  constexpr explicit Vector3(const Vector3<U>& o) : x(T(o.x)), y(T(o.y)), z(T(o.z)) {}

  constexpr Vector3& operator+=(const Vector3& o) { return x += o.x, y += o.y, z += o.z, *this; }
  constexpr Vector3& operator-=(const Vector3& o) { return x -= o.x, y -= o.y, z -= o.z, *this; }
  constexpr Vector3& operator*=(T s) { return x *= s, y *= s, z *= s, *this; }
  constexpr Vector3 operator-() const { return {-x, -y, -z}; }
  friend constexpr Vector3 operator+(Vector3 a, const Vector3& b) { return a += b; }
  friend constexpr Vector3 operator-(Vector3 a, const Vector3& b) { return a -= b; }
  friend constexpr Vector3 operator*(Vector3 a, T s) { return a *= s; }
  friend constexpr Vector3 operator*(T s, Vector3 a) { return a *= s; }
  friend constexpr Vector3 operator/(const Vector3& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
  friend constexpr bool operator==(const Vector3&, const Vector3&) = default;
};

using Vec3 = Vector3<Real>;
using Vec3f = Vector3<float>;

template <class T>
constexpr T dot(const Vector3<T>& a, const Vector3<T>& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
template <class T>
constexpr Vector3<T> cross(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
constexpr T squared_norm(const Vector3<T>& a) { return dot(a, a); }
template <class T>
T norm(const Vector3<T>& a) { return std::sqrt(dot(a, a)); }
// The unit vector along a; a itself where a is zero.
template <class T>
Vector3<T> normalized(const Vector3<T>& a) {
  const T n = norm(a);
  return n > T(0) ? a / n : a;
}
template <class T>
bool is_finite(const Vector3<T>& a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

constexpr Real radians(Real degrees) { return degrees * (pi / 180); }
constexpr Real degrees(Real radians) { return radians * (180 / pi); }

}  // namespace imbibe
