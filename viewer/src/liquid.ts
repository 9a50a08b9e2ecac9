// The free liquid of one swatch: particles as points. Plain: shaded balls. Fine: their depths, smoothed on the screen,
// make one surface (screen-space fluid; van der Laan, Green and Sainz 2009), drawn by LiquidSurface.
import * as THREE from 'three';
import type { Points } from './protocol';
import { MM } from './yarns';

// A sphere on the screen: its nearest point to the eye, in view space.
const SPHERE_VERTEX = `
uniform float uRadius; uniform float uPixels;
varying vec3 vCentre;
void main() {
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  vCentre = eye.xyz;
  gl_Position = projectionMatrix * eye;
  gl_PointSize = max(1.0, uPixels * uRadius * projectionMatrix[1][1] / -eye.z);
}`;
const SPHERE_HEAD = `
uniform float uRadius; uniform mat4 uProjection; uniform vec4 uCut;
varying vec3 vCentre;
vec3 sphere(out vec3 normal) {
  vec2 c = 2.0 * gl_PointCoord - 1.0; c.y = -c.y;
  float r2 = dot(c, c);
  if (r2 > 1.0) discard;
  normal = vec3(c, sqrt(1.0 - r2));
  vec3 p = vCentre + uRadius * normal;
  if (dot(uCut, vec4(p, 1.0)) < 0.0) discard;
  return p;
}
float depthOf(vec3 p) { vec4 c = uProjection * vec4(p, 1.0); return 0.5 * c.z / c.w + 0.5; }`;

export interface LiquidUniforms {
  uRadius: { value: number }; uPixels: { value: number }; uProjection: { value: THREE.Matrix4 }; uCut: { value: THREE.Vector4 };
}

export class Liquid {
  readonly balls: THREE.Points;
  readonly depth: THREE.Points;
  readonly thickness: THREE.Points;
  count = 0;
  private readonly geometry = new THREE.BufferGeometry();
  private capacity = 0;
  readonly uniforms: LiquidUniforms;
  private readonly thick: { value: number };

  constructor(private spacing: number) {
    const radius = MM * spacing;
    this.uniforms = { uRadius: { value: 0.62 * radius }, uPixels: { value: 600 }, uProjection: { value: new THREE.Matrix4() },
      uCut: { value: new THREE.Vector4(0, 0, 0, 1) } };
    this.thick = { value: radius };
    const make = (fragment: string, more: THREE.ShaderMaterialParameters, uniforms = {}) => {
      const points = new THREE.Points(this.geometry, new THREE.ShaderMaterial({
        uniforms: { ...this.uniforms, ...uniforms }, vertexShader: SPHERE_VERTEX, fragmentShader: SPHERE_HEAD + fragment, ...more }));
      points.frustumCulled = false;
      return points;
    };
    this.balls = make(`
      void main() {
        vec3 n; vec3 p = sphere(n);
        gl_FragDepth = depthOf(p);
        vec3 light = normalize(vec3(0.35, 0.6, 0.75));
        float lit = 0.35 + 0.65 * max(0.0, dot(n, light));
        float shine = pow(max(0.0, dot(reflect(-light, n), normalize(-p))), 40.0);
        gl_FragColor = vec4(mix(vec3(0.12, 0.38, 0.72), vec3(0.50, 0.74, 0.95), lit) * (0.55 + 0.45 * lit) + 0.6 * shine, 1.0);
        #include <colorspace_fragment>
      }`, {});
    this.depth = make(`
      void main() { vec3 n; vec3 p = sphere(n); gl_FragDepth = depthOf(p); gl_FragColor = vec4(-p.z, 0.0, 0.0, 1.0); }`, {});
    this.thickness = make(`
      uniform float uThick;
      void main() { vec3 n; sphere(n); gl_FragColor = vec4(uThick * n.z, 0.0, 0.0, 1.0); }`,
      { blending: THREE.CustomBlending, blendEquation: THREE.AddEquation, blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor,
        depthWrite: false, depthTest: false }, { uThick: this.thick });
  }

  set(points: Points): void {
    const { origin, step, xyz } = points;
    const count = xyz.length / 3;
    if (count > this.capacity) {
      this.capacity = Math.ceil(1.5 * count) + 64;
      this.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * this.capacity), 3).setUsage(THREE.DynamicDrawUsage));
    }
    this.count = count;
    if (points.every !== this.every) this.every = points.every, this.size();
    this.geometry.setDrawRange(0, count);
    const attribute = this.geometry.getAttribute('position') as THREE.BufferAttribute | undefined;
    if (!attribute) return;
    const at = attribute.array as Float32Array;
    for (let i = 0; i < 3 * count; ++i) at[i] = MM * (origin[i % 3]! + step[i % 3]! * xyz[i]!);
    attribute.needsUpdate = true;
  }

  // Smooth surfaces want larger balls than shaded ones, so that no gaps show.
  forSurface(on: boolean, spacing: number): void { this.spacing = spacing, this.smooth = on, this.size(); }

  // One that stands for many is as large as they are together.
  private every = 1;
  private smooth = false;
  private size(): void {
    const spacing = MM * this.spacing * Math.cbrt(this.every);
    this.uniforms.uRadius.value = spacing * (this.smooth ? 0.85 : 0.62), this.thick.value = spacing;
  }

  dispose(): void {
    this.geometry.dispose();
    for (const points of [this.balls, this.depth, this.thickness]) (points.material as THREE.Material).dispose();
  }
}
