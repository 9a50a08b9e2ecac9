// Draws the liquid of a view as one smooth surface: depths of the particles, smoothed by a bilateral filter that keeps
// silhouettes, give normals; thickness gives colour and how much of the scene behind is seen, bent.
import * as THREE from 'three';
import type { Liquid } from './liquid';

const QUAD_VERTEX = 'varying vec2 vUv; void main() { vUv = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }';

const SMOOTH = `
uniform sampler2D uDepth; uniform vec2 uDirection; uniform float uFilter; uniform float uRange; uniform float uFocal;
varying vec2 vUv;
void main() {
  float here = texture2D(uDepth, vUv).r;
  if (here <= 0.0) { gl_FragColor = vec4(0.0); return; }
  // The filter is as wide as about two particles, whatever their distance.
  float reach = clamp(uFilter * uFocal / here, 1.0, 60.0), stride = max(1.0, reach / 6.0);
  float sum = here, weight = 1.0;
  for (int i = 1; i <= 12; ++i) {
    float x = float(i) * stride / reach, g = exp(-0.5 * x * x);
    for (int s = -1; s <= 1; s += 2) {
      float there = texture2D(uDepth, vUv + float(s * i) * stride * uDirection).r;
      if (there <= 0.0) continue;
      float d = (there - here) / uRange, w = g * exp(-0.5 * d * d);
      sum += w * there; weight += w;
    }
  }
  gl_FragColor = vec4(sum / weight, 0.0, 0.0, 1.0);
}`;

const COMPOSE = `
uniform sampler2D uScene; uniform sampler2D uSceneDepth; uniform sampler2D uDepth; uniform sampler2D uThickness;
uniform vec2 uTexel; uniform mat4 uProjection; uniform mat4 uInverse; uniform mat4 uToWorld; uniform float uDark; uniform float uRadius;
varying vec2 vUv;
vec3 at(vec2 uv, float d) {
  vec2 ndc = 2.0 * uv - 1.0;
  return vec3(ndc.x * d / uProjection[0][0], ndc.y * d / uProjection[1][1], -d);
}
const vec3 LAMP = vec3(0.395, -0.467, 0.791);  // unit; where the sun of Swatch stands
vec3 sky(vec3 r) {
  float up = 0.5 + 0.5 * r.z;
  vec3 day = mix(vec3(0.45, 0.47, 0.50), vec3(0.93, 0.96, 1.0), smoothstep(0.2, 0.95, up));
  float lamp = smoothstep(0.90, 0.985, dot(r, LAMP));
  return mix(day, day * vec3(0.35, 0.38, 0.45), uDark) + 1.6 * lamp;
}
void main() {
  vec4 scene = texture2D(uScene, vUv);
  float d = texture2D(uDepth, vUv).r;
  gl_FragColor = scene;
  if (d > 0.0) {
    vec3 p = at(vUv, d);
    vec4 c = uProjection * vec4(p, 1.0);
    float depth = 0.5 * c.z / c.w + 0.5, behind = texture2D(uSceneDepth, vUv).r;
    if (depth <= behind) {
      float dx1 = texture2D(uDepth, vUv + vec2(uTexel.x, 0.0)).r, dx0 = texture2D(uDepth, vUv - vec2(uTexel.x, 0.0)).r;
      float dy1 = texture2D(uDepth, vUv + vec2(0.0, uTexel.y)).r, dy0 = texture2D(uDepth, vUv - vec2(0.0, uTexel.y)).r;
      vec3 ddx = abs(dx1 - d) < abs(d - dx0) && dx1 > 0.0 || dx0 <= 0.0 ? at(vUv + vec2(uTexel.x, 0.0), dx1 > 0.0 ? dx1 : d) - p : p - at(vUv - vec2(uTexel.x, 0.0), dx0);
      vec3 ddy = abs(dy1 - d) < abs(d - dy0) && dy1 > 0.0 || dy0 <= 0.0 ? at(vUv + vec2(0.0, uTexel.y), dy1 > 0.0 ? dy1 : d) - p : p - at(vUv - vec2(0.0, uTexel.y), dy0);
      vec3 n = normalize(cross(ddx, ddy));
      vec3 eye = normalize(-p);
      // The free surface of what lies behind bounds how far one sees through.
      vec4 q = uInverse * vec4(2.0 * vUv - 1.0, 2.0 * behind - 1.0, 1.0);
      float thick = min(texture2D(uThickness, vUv).r, max(0.0, -q.z / q.w - d) + 0.3);
      // A flat bottom seen through a face tilted by n is moved by about a quarter of the depth.
      vec2 bend = vUv - 0.25 * clamp(thick, 0.0, 3.0) * n.xy * 0.5 * vec2(uProjection[0][0], uProjection[1][1]) / d;
      vec3 seen = texture2D(uScene, bend).rgb;
      // Stronger than water's own colour, so that a drop of a millimetre is seen.
      vec3 through = seen * exp(-thick * vec3(0.55, 0.17, 0.05));
      float facing = max(0.0, dot(n, eye));
      float fresnel = 0.02 + 0.98 * pow(1.0 - facing, 5.0);
      vec3 mirrored = mat3(uToWorld) * reflect(-eye, n);
      vec3 colour = mix(through, sky(mirrored), clamp(fresnel, 0.0, 0.85));
      float rim = smoothstep(0.0, 0.35, facing);
      // The lamp's own reflection is a few pixels wide on a drop: drawn wider, so that its shape is read.
      float lit = 0.5 + 0.5 * dot(mat3(uToWorld) * n, LAMP), shine = rim * smoothstep(0.3, 1.6, thick / uRadius) * pow(max(0.0, dot(mirrored, LAMP)), 70.0);
      gl_FragColor = vec4(colour * mix(0.55, 1.0, rim) * mix(0.72, 1.08, lit) + 0.6 * shine * mix(1.0, 0.6, uDark), 1.0);
    }
  }
  #include <colorspace_fragment>
}`;

export class LiquidSurface {
  private readonly colour = new THREE.WebGLRenderTarget(1, 1, { type: THREE.HalfFloatType, samples: 4 });
  private readonly depths: [THREE.WebGLRenderTarget, THREE.WebGLRenderTarget];
  private readonly thickness: THREE.WebGLRenderTarget;
  private readonly quad: THREE.Mesh;
  private readonly quadScene = new THREE.Scene();
  private readonly flat = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 1);
  private readonly smooth: THREE.ShaderMaterial;
  private readonly compose: THREE.ShaderMaterial;
  private readonly particles = new THREE.Scene();

  constructor() {
    this.colour.depthTexture = new THREE.DepthTexture(1, 1, THREE.UnsignedIntType);
    const depth = () => new THREE.WebGLRenderTarget(1, 1, { type: THREE.FloatType, format: THREE.RedFormat, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter });
    this.depths = [depth(), depth()];
    this.thickness = new THREE.WebGLRenderTarget(1, 1, { type: THREE.HalfFloatType, format: THREE.RedFormat, depthBuffer: false });
    this.smooth = new THREE.ShaderMaterial({ vertexShader: QUAD_VERTEX, fragmentShader: SMOOTH, depthTest: false, depthWrite: false,
      uniforms: { uDepth: { value: null }, uDirection: { value: new THREE.Vector2() }, uFilter: { value: 1 }, uRange: { value: 1 }, uFocal: { value: 1 } } });
    this.compose = new THREE.ShaderMaterial({ vertexShader: QUAD_VERTEX, fragmentShader: COMPOSE, depthTest: false, depthWrite: false,
      uniforms: { uScene: { value: this.colour.texture }, uSceneDepth: { value: this.colour.depthTexture }, uDepth: { value: null },
        uThickness: { value: this.thickness.texture }, uTexel: { value: new THREE.Vector2() }, uProjection: { value: new THREE.Matrix4() },
        uInverse: { value: new THREE.Matrix4() }, uToWorld: { value: new THREE.Matrix4() }, uDark: { value: 0 }, uRadius: { value: 1 } } });
    this.quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), this.smooth);
    this.quad.frustumCulled = false;
    this.quadScene.add(this.quad);
  }

  render(renderer: THREE.WebGLRenderer, scene: THREE.Scene, camera: THREE.PerspectiveCamera, liquid: Liquid, area: THREE.Vector4, dark: boolean): void {
    const ratio = renderer.getPixelRatio();
    const width = Math.max(1, Math.round(area.z * ratio)), height = Math.max(1, Math.round(area.w * ratio));
    this.colour.setSize(width, height);
    for (const target of [...this.depths, this.thickness]) target.setSize(width, height);
    renderer.setScissorTest(false);
    renderer.setRenderTarget(this.colour);
    renderer.render(scene, camera);
    const uniforms = liquid.uniforms;
    uniforms.uPixels.value = height;
    const clear = renderer.getClearColor(new THREE.Color()), alpha = renderer.getClearAlpha();
    renderer.setClearColor(0, 0);
    this.particles.clear();
    this.particles.add(liquid.depth);
    renderer.setRenderTarget(this.depths[0]);
    renderer.clear();
    renderer.render(this.particles, camera);
    this.particles.clear();
    this.particles.add(liquid.thickness);
    renderer.setRenderTarget(this.thickness);
    renderer.clear();
    renderer.render(this.particles, camera);
    const smooth = this.smooth.uniforms;
    smooth['uFilter']!.value = 1.1 * uniforms.uRadius.value;
    smooth['uRange']!.value = 2.2 * uniforms.uRadius.value;
    smooth['uFocal']!.value = 0.5 * height * camera.projectionMatrix.elements[5]!;
    this.quad.material = this.smooth;
    for (let pass = 0; pass < 6; ++pass) {
      smooth['uDepth']!.value = this.depths[pass % 2]!.texture;
      (smooth['uDirection']!.value as THREE.Vector2).set(pass % 2 ? 0 : 1 / width, pass % 2 ? 1 / height : 0);
      renderer.setRenderTarget(this.depths[(pass + 1) % 2]!);
      renderer.render(this.quadScene, this.flat);
    }
    renderer.setClearColor(clear, alpha);
    renderer.setRenderTarget(null);
    renderer.setViewport(area);
    renderer.setScissor(area);
    renderer.setScissorTest(true);
    const c = this.compose.uniforms;
    c['uDepth']!.value = this.depths[0].texture;  // an even number of passes ends there
    (c['uTexel']!.value as THREE.Vector2).set(1 / width, 1 / height);
    (c['uProjection']!.value as THREE.Matrix4).copy(camera.projectionMatrix);
    (c['uInverse']!.value as THREE.Matrix4).copy(camera.projectionMatrixInverse);
    (c['uToWorld']!.value as THREE.Matrix4).copy(camera.matrixWorld);
    c['uDark']!.value = dark ? 1 : 0;
    c['uRadius']!.value = uniforms.uRadius.value;
    this.quad.material = this.compose;
    renderer.render(this.quadScene, this.flat);
  }

  dispose(): void {
    for (const target of [this.colour, ...this.depths, this.thickness]) target.dispose();
    this.smooth.dispose();
    this.compose.dispose();
    this.quad.geometry.dispose();
  }
}
