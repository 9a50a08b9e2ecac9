#include "imbibe/view/shading.h"

#include <algorithm>
#include <cmath>

#include "imbibe/view/colour_bar.h"

namespace imbibe {

namespace {

constexpr float water_index = 1.333f;
constexpr float far_away = 1e6f;
constexpr int most_interfaces = 8;
enum Purpose : std::uint64_t { for_pixel = 0, for_light = 1, for_sky = 2 };

Vec3f product(const Vec3f& a, const Vec3f& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
Vec3f mix(const Vec3f& a, const Vec3f& b, float t) { return a * (1 - t) + b * t; }
Vec3f attenuation(const Vec3f& per_metre, float way) {
  return {std::exp(-per_metre.x * way), std::exp(-per_metre.y * way), std::exp(-per_metre.z * way)};
}
float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

struct Basis {
  Vec3f a, b;
};
Basis basis_about(const Vec3f& n) {
  const Vec3f a = normalized(std::abs(n.z) < 0.9f ? cross(Vec3f{0, 0, 1}, n) : cross(Vec3f{1, 0, 0}, n));
  return {a, cross(n, a)};
}

Vec3f cosine_direction(const Vec3f& n, const Pair& s) {
  const float radius = std::sqrt(s.u), angle = 2 * std::numbers::pi_v<float> * s.v;
  const Basis basis = basis_about(n);
  return normalized(basis.a * (radius * std::cos(angle)) + basis.b * (radius * std::sin(angle)) +
                    n * std::sqrt(std::max(0.0f, 1 - s.u)));
}

Vec3f light_direction(const Look& look, const Pair& s) {
  const float radius = look.light_size * std::sqrt(s.u), angle = 2 * std::numbers::pi_v<float> * s.v;
  const Basis basis = basis_about(look.to_light);
  return normalized(look.to_light + basis.a * (radius * std::cos(angle)) + basis.b * (radius * std::sin(angle)));
}

Vec3f sky(const Look& look, const Vec3f& direction) {
  return mix(look.sky_horizon, look.sky_up, std::pow(std::max(0.0f, direction.z), 0.6f));
}

// What a mirror sees of the studio: the sky and a square window where water shows it best.
Vec3f studio(const Look& look, const Vec3f& direction) {
  const Basis basis = basis_about(look.to_window);
  const float ahead = dot(direction, look.to_window);
  Vec3f seen = sky(look, direction);
  if (ahead > 0) {
    const float x = dot(direction, basis.a) / ahead, y = dot(direction, basis.b) / ahead, half = 0.20f;
    const float box = (1 - smoothstep(half - 0.02f, half, std::abs(x))) * (1 - smoothstep(half - 0.02f, half, std::abs(y)));
    seen += (look.style == PictureStyle::diagram ? Vec3f{1, 1, 1} * 16.0f : look.light * 34.0f) * box;
  }
  return seen;
}

struct Surface {
  Vec3f position, normal, flat_normal;
  Vec3f colour;      // linear RGB, diffuse
  float gloss = 0;   // 0..1, share of a water film
};

struct Lighting {
  Vec3f diffuse, sky;  // radiance per colour; sky: of it, what the open sky gives, for sheen
  float light_seen = 0;
};

Lighting lighting_at(const RayScene& scene, const Look& look, const Surface& s, const PixelSamples& samples) {
  const Vec3f start = s.position + s.flat_normal * scene.skin();
  Lighting result;
  const Vec3f to_light = light_direction(look, samples.pair(for_light));
  const float facing = dot(to_light, s.normal);
  if (facing > 0 && dot(to_light, s.flat_normal) > 0 && !scene.solid_between({start, to_light}, far_away)) {
    // Water gathers as much light as it keeps off; a part is reflected away.
    result.light_seen = scene.liquid_between({start, to_light}, far_away) ? 0.92f : 1.0f;
    result.diffuse += look.light * (facing * result.light_seen);
  }
  const Vec3f up = cosine_direction(s.normal, samples.pair(for_sky));
  if (dot(up, s.flat_normal) > 0 && !scene.solid_between({start, up}, far_away)) {
    // Below the horizon the ground sends back what it got.
    result.sky = up.z > 0 ? sky(look, up) : product(look.ground, look.sky_up) * 0.6f;
    result.diffuse += result.sky;
  } else {
    result.diffuse += look.returned;
  }
  return result;
}

// Highlight of a rough film under the light, normalised Blinn-Phong.
float highlight(const Vec3f& normal, const Vec3f& to_eye, const Vec3f& to_light, float exponent) {
  const float cosine = std::max(0.0f, dot(normal, normalized(to_eye + to_light)));
  return (exponent + 8) / (8 * std::numbers::pi_v<float>) * std::pow(cosine, exponent);
}

Vec3f shade(const RayScene& scene, const Look& look, const Surface& s, const Vec3f& direction, const PixelSamples& samples) {
  const Lighting light = lighting_at(scene, look, s, samples);
  Vec3f seen = product(s.colour, light.diffuse);
  if (s.gloss > 0) {
    const float cosine = std::max(0.05f, -dot(direction, s.normal));
    const float reflected = fresnel_reflectance(cosine, 1, water_index);
    const Vec3f shine = look.light * (light.light_seen * std::max(0.0f, dot(look.to_light, s.normal)) *
                                      (0.35f * highlight(s.normal, -direction, look.to_light, 24) +
                                       0.30f * highlight(s.normal, -direction, look.to_light, 160)));
    seen += (light.sky * reflected + shine) * s.gloss;
  }
  return seen;
}

// Smooth noise in [-1, 1] along a line, one value per unit.
float noise_along(float x, std::uint64_t stream) {
  const float cell = std::floor(x), t = x - cell, blend = t * t * (3 - 2 * t);
  const auto value = [&](float c) {
    return static_cast<float>(2 * uniform({0xc107, static_cast<std::uint64_t>(static_cast<std::int64_t>(c)), stream}) - 1);
  };
  return value(cell) * (1 - blend) + value(cell + 1) * blend;
}

// Fibres lie in a helix about the yarn: their ridges turn the normal and darken the valleys. `footprint`: width of a
// pixel on the yarn; ridges finer than that fade out instead of flickering.
void lay_fibres(const SolidHit& hit, float footprint, Surface& s) {
  constexpr float twist = 0.42f;  // tangent of the surface fibres' angle to the yarn's axis
  const float around_length = 2 * std::numbers::pi_v<float> * hit.radius;
  const float turn = hit.around + hit.along * twist / hit.radius;
  const Vec3f circle = normalized(cross(s.normal, hit.axis));
  const Vec3f across_fibres = normalized(circle + hit.axis * twist);
  const float wet = std::clamp(hit.saturation, 0.0f, 1.0f);
  float tilt = 0, valley = 0;
  for (const float count : {5.0f, 13.0f}) {
    const float fade = 1 - smoothstep(0.25f, 0.7f, footprint * count / around_length);
    if (fade <= 0) continue;
    const float wander = 1.6f * noise_along(hit.along / (6 * hit.radius), static_cast<std::uint64_t>(count));
    const float phase = count * turn + wander;
    tilt += fade * std::cos(phase) * (count > 6 ? 0.22f : 0.30f);
    valley += fade * (0.5f - 0.5f * std::sin(phase)) * (count > 6 ? 0.10f : 0.16f);
  }
  const float bump = 1 - 0.55f * wet;
  const Vec3f turned = normalized(s.normal - across_fibres * (tilt * bump));
  s.normal = turned;
  s.colour *= (1 - valley * (1 - 0.4f * wet)) * (1 + 0.03f * noise_along(hit.along / (9 * hit.radius), 77));
}

// What all rays of one camera sample share.
struct Trace {
  const RayScene& scene;
  const Look& look;
  const PixelSamples& samples;
  std::vector<Index>& touched;
};

void touch(std::vector<Index>& touched, Index point) {
  if (touched.empty() || touched.back() != point) touched.push_back(point);
}

Surface surface_of(const Trace& trace, const Ray& ray, const SolidHit& hit) {
  const Look& look = trace.look;
  Surface s{ray.origin + ray.direction * hit.distance, hit.normal, hit.flat_normal, hit.colour, 0};
  if (hit.cloth) {
    if (look.style == PictureStyle::diagram) {
      const Vec3f shown = over(colour_of_saturation(std::clamp(hit.saturation, 0.0f, 1.0f)), {1, 1, 1});
      s.colour = Vec3f{linear_from_srgb(shown.x), linear_from_srgb(shown.y), linear_from_srgb(shown.z)} * 0.97f;
    } else {
      s.colour = wet_colour(hit.colour, hit.saturation);
      // Menisci lie between the fibres until the cloth is full: only what it holds beyond that shines as a film.
      s.gloss = 0.6f * smoothstep(0.95f, 1.4f, hit.saturation);
    }
    return s;
  }
  if (!hit.yarn) return s;
  if (look.style == PictureStyle::diagram) {
    touch(trace.touched, hit.nearest);
    const Vec3f shown = over(colour_of_saturation(hit.nearest_saturation), {1, 1, 1});
    s.colour = Vec3f{linear_from_srgb(shown.x), linear_from_srgb(shown.y), linear_from_srgb(shown.z)} * 0.97f;
    return s;
  }
  touch(trace.touched, hit.point);
  touch(trace.touched, hit.point + 1);
  s.colour = wet_colour(hit.colour, hit.saturation);
  // Between the fibres of a full yarn menisci are bent inwards and scatter what they mirror; what bulges out of them is a film.
  s.gloss = 0.3f * smoothstep(0.15f, 1.0f, hit.saturation) + 0.4f * smoothstep(1.0f, 1.1f, hit.saturation);
  if (hit.cut_end) {
    s.colour *= 0.8f;  // light sinks in between the fibres' ends
  } else {
    lay_fibres(hit, hit.distance * look.pixel_angle, s);
  }
  return s;
}

// The table, without end: it melts into the light of the horizon.
Vec3f ground_seen(const RayScene& scene, const Look& look, const Ray& ray, float distance, const PixelSamples& samples) {
  const Vec3f up{0, 0, 1};
  Surface s{ray.origin + ray.direction * distance, up, up, look.ground, 0};
  const Vec3f off = s.position - look.centre;
  const float away = std::sqrt(off.x * off.x + off.y * off.y) / look.content_size;
  if (look.style == PictureStyle::natural) s.colour *= 1.12f - 0.5f * smoothstep(0.2f, 2.2f, away);
  const Vec3f lit = shade(scene, look, s, ray.direction, samples);
  const Vec3f end = look.style == PictureStyle::diagram ? Vec3f{1, 1, 1} : look.ground * 0.55f;
  return mix(lit, end, smoothstep(3.0f, 14.0f, away));
}

Vec3f background(const Look& look, const Vec3f& direction) {
  if (look.style == PictureStyle::diagram) return {1, 1, 1};
  return mix(look.ground * 0.55f, look.ground * 0.9f, smoothstep(0.0f, 0.5f, direction.z));
}

// Light along a ray that meets no water.
Vec3f opaque_radiance(const Trace& trace, const Ray& ray, const SolidHit* hit, float limit, bool mirrored,
                      TracedPixel* first) {
  const Look& look = trace.look;
  if (hit) {
    const Surface surface = surface_of(trace, ray, *hit);
    if (first) first->surface = surface.colour, first->normal = hit->normal, first->depth = hit->distance;
    return shade(trace.scene, look, surface, ray.direction, trace.samples);
  }
  const float drop = look.ground_height - ray.origin.z;
  const float distance = ray.direction.z < -1e-6f ? drop / ray.direction.z : -1;
  if (distance > 0 && distance < limit) {
    if (first) first->surface = look.ground, first->normal = {0, 0, 1}, first->depth = distance;
    return ground_seen(trace.scene, look, ray, distance, trace.samples);
  }
  return mirrored ? studio(look, ray.direction) : background(look, ray.direction);
}

struct Bend {
  Vec3f reflected, refracted;  // unit
  float reflectance = 1;
};

Bend bend_at(const Vec3f& direction, const LiquidHit& hit) {
  const Vec3f n = hit.entering ? hit.normal : -hit.normal;  // towards the ray
  const float n1 = hit.entering ? 1 : water_index, n2 = hit.entering ? water_index : 1;
  const float cosine = std::clamp(-dot(direction, n), 0.0f, 1.0f), ratio = n1 / n2;
  Bend bend;
  bend.reflected = normalized(direction + n * (2 * cosine));
  bend.reflectance = fresnel_reflectance(cosine, n1, n2);
  const float k = 1 - ratio * ratio * (1 - cosine * cosine);
  bend.refracted = k > 0 ? normalized(direction * ratio + n * (ratio * cosine - std::sqrt(k))) : bend.reflected;
  return bend;
}

Vec3f reflected_radiance(const Trace& trace, const Ray& ray) {
  SolidHit hit;
  const bool met = trace.scene.meets_solid(ray, far_away, hit);
  return opaque_radiance(trace, ray, met ? &hit : nullptr, far_away, true, nullptr);
}

}  // namespace

float fresnel_reflectance(float cosine, float n1, float n2) {
  const float sine2 = (n1 / n2) * (n1 / n2) * (1 - cosine * cosine);
  if (sine2 >= 1) return 1;
  const float other = std::sqrt(1 - sine2);
  const float across = (n1 * cosine - n2 * other) / (n1 * cosine + n2 * other);
  const float along = (n1 * other - n2 * cosine) / (n1 * other + n2 * cosine);
  return 0.5f * (across * across + along * along);
}

Vec3f wet_colour(const Vec3f& dry, float saturation) {
  const float s = std::clamp(saturation, 0.0f, 1.0f);
  const float wet = s * (2 - s);  // most of the darkening comes with the first water
  const float power = 1 + 1.2f * wet, scale = 1 - 0.38f * wet;
  return Vec3f{std::pow(dry.x, power), std::pow(dry.y, power), std::pow(dry.z, power)} * scale;
}

Look look_for(const LookInput& in) {
  Look look;
  look.style = in.style;
  look.ground_height = in.ground_height;
  look.content_size = in.content_size;
  look.centre = in.centre;
  look.pixel_angle = in.pixel_angle;
  look.contact_gap = in.contact_gap;
  Vec3f ahead = normalized(Vec3f{in.forward.x, in.forward.y, 0});
  if (squared_norm(ahead) < 0.5f) ahead = normalized(cross(Vec3f{0, 0, 1}, in.right));
  const float depth = std::max(in.liquid_depth, 1e-6f);
  if (in.style == PictureStyle::diagram) {
    // A light table: white, lit from above the left shoulder, shadows light.
    look.to_light = normalized(in.right * -0.55f + ahead * -0.25f + Vec3f{0, 0, 1});
    look.to_window = look.to_light;
    look.light_size = 0.30f;
    look.light = Vec3f{1, 1, 1} * 0.50f;
    look.sky_up = Vec3f{1, 1, 1} * 0.62f;
    look.sky_horizon = look.sky_up;
    look.returned = Vec3f{0.13f, 0.13f, 0.14f};
    look.ground = Vec3f{1, 1, 1} / (0.62f + 0.50f * look.to_light.z);
    look.water_absorption = Vec3f{1.05f, 0.50f, 0.16f} / depth;
    look.water_scattered = Vec3f{0.22f, 0.47f, 0.86f};
  } else {
    // A studio: a large soft light behind the left of the subject, a cool sky, a warm table. Who looks along the table sees the
    // faces of upright cloth: then it stands in front of them.
    const float behind = smoothstep(0.24f, 0.34f, -in.forward.z);
    look.to_light = normalized(in.right * -0.62f + ahead * (0.95f * behind - 0.4f) + Vec3f{0, 0, 1.0f});
    look.to_window = normalized(in.right * -0.75f + ahead * -0.35f + Vec3f{0, 0, 1.0f});
    look.light_size = 0.22f;
    look.light = Vec3f{1.0f, 0.92f, 0.80f} * 1.18f;
    look.sky_up = Vec3f{0.80f, 0.90f, 1.0f} * 0.36f;
    look.sky_horizon = Vec3f{1.0f, 0.90f, 0.78f} * 0.20f;
    look.returned = Vec3f{0.075f, 0.062f, 0.050f};
    look.ground = Vec3f{0.235f, 0.150f, 0.098f};
    look.water_absorption = Vec3f{0.06f, 0.020f, 0.015f} / depth;
    look.water_scattered = {};
  }
  return look;
}

std::uint8_t shown_saturation(PictureStyle style, float saturation) {
  if (style == PictureStyle::diagram) return static_cast<std::uint8_t>(colour_level(saturation));
  return static_cast<std::uint8_t>(std::lround(32 * std::clamp(saturation, 0.0f, 1.0f)));
}

float shown_value(PictureStyle style, std::uint8_t shown) {
  return static_cast<float>(shown) / (style == PictureStyle::diagram ? 10.0f : 32.0f);
}

TracedPixel trace(const RayScene& scene, const Look& look, const Ray& from_camera, const PixelSamples& samples,
                  std::vector<Index>& touched) {
  const Trace trace{scene, look, samples, touched};
  TracedPixel result;
  Ray ray = from_camera;
  Vec3f seen{}, share{1, 1, 1}, water_normal{};
  float way_before = 0;
  for (int interface = 0; interface < most_interfaces; ++interface) {
    SolidHit solid;
    const bool met_solid = scene.meets_solid(ray, far_away, solid);
    const float limit = met_solid ? solid.distance : far_away;
    LiquidHit water;
    const bool met_water = scene.meets_liquid(ray, limit, water);
    // A solid, or the open, reached from inside the water: its way is taken off below, when the water's end is found.
    if (!met_water) {
      const Vec3f behind = opaque_radiance(trace, ray, met_solid ? &solid : nullptr, far_away, interface > 0, &result);
      result.light = seen + product(share, behind);
      result.normal += water_normal;  // the filter keeps the outline of a drop as an edge
      result.depth += way_before;
      return result;
    }
    if (interface == 0) water_normal = water.normal;
    way_before += water.distance;
    const Vec3f at = ray.origin + ray.direction * water.distance;
    const Bend bend = bend_at(ray.direction, water);
    if (water.entering) {
      const float reflectance = look.style == PictureStyle::diagram ? 0.8f * bend.reflectance : bend.reflectance;
      if (interface == 0) {
        const Ray mirror{at + water.normal * scene.skin(), bend.reflected};
        seen += reflected_radiance(trace, mirror) * reflectance;
      }
      share *= 1 - reflectance;
    }
    // Water that ends just above a solid lies on it: particles leave a gap there that is not air.
    const bool touching = !water.entering && met_solid && limit - water.distance < look.contact_gap;
    const bool straight = look.style == PictureStyle::diagram || touching;
    if (!straight) ray.direction = bend.refracted;
    ray.origin = at + ray.direction * scene.skin();
    const bool inside = water.entering || (!straight && bend.reflectance >= 1);
    if (!inside) continue;
    // The way through the water up to its far side or to what stands in it.
    SolidHit end_solid;
    LiquidHit end_water;
    float way = scene.meets_solid(ray, far_away, end_solid) ? end_solid.distance : far_away;
    if (scene.meets_liquid(ray, way, end_water)) way = end_water.distance;
    if (way >= far_away) continue;
    const Vec3f through = attenuation(look.water_absorption, way);
    seen += product(share, product(Vec3f{1, 1, 1} - through, look.water_scattered));
    share = product(share, through);
  }
  result.light = seen + product(share, look.returned);
  return result;
}

}  // namespace imbibe
