// The yarns of one textile as round tubes: one instanced piece of tube per segment. Positions and saturations come from
// textures, so that a frame uploads a few kilobytes and never rebuilds geometry; a moving sheet only replaces the
// points' texture.
import * as THREE from 'three';
import type { Points, TextileInfo } from './protocol';
import type { Sheet } from './sheet';

export const MM = 1000;  // the page draws in millimetres

const WIDTH = 1024;  // of the data textures

function dataTexture(count: number, components: 1 | 4, data: Float32Array | Uint8Array): THREE.DataTexture {
  const height = Math.max(1, Math.ceil(count / WIDTH));
  const texture = new THREE.DataTexture(data, WIDTH, height, components === 4 ? THREE.RGBAFormat : THREE.RedFormat,
    data instanceof Float32Array ? THREE.FloatType : THREE.UnsignedByteType);
  texture.needsUpdate = true;
  return texture;
}

const padded = (count: number) => WIDTH * Math.max(1, Math.ceil(count / WIDTH));

export interface YarnLook {
  natural: { value: number };            // 0 the colour bar, 1 natural colours
  bar: { value: THREE.Vector4[] };       // 11 colours, opacity in w
  levels: { value: number };
  scale: { value: number };              // saturation steps
  pixels: { value: number };             // height of the picture
}

const HEAD = `
uniform sampler2D uPoints; uniform sampler2D uSaturation; uniform float uPixels;
uniform vec3 uAcross0; uniform vec3 uAcross1; uniform vec3 uNormal; uniform float uMiddle; uniform float uScale;
uniform float uMoved; uniform float uHalfLoop;
attribute vec2 aPlace;              // ring of the piece, angle
attribute vec4 aPiece;              // first point, first and last point of the yarn, radius
attribute vec4 aYarn;               // colour, family
attribute float aNode;
vec3 pointAt(float i) { int k = int(i + 0.5); return texelFetch(uPoints, ivec2(k % ${WIDTH}, k / ${WIDTH}), 0).xyz; }
void place(out vec3 position_, out vec3 normal_) {
  float i = aPiece.x + aPlace.x;
  vec3 p = pointAt(i);
  vec3 t = normalize(pointAt(min(i + 1.0, aPiece.z)) - pointAt(max(i - 1.0, aPiece.y)));
  vec3 side = mix(uAcross0, uAcross1, aYarn.w);
  if (abs(dot(side, t)) > 0.9) side = uNormal;  // a sheet that hangs across
  vec3 up = normalize(cross(t, side)); side = cross(up, t);
  normal_ = cos(aPlace.y) * side + sin(aPlace.y) * up;
  position_ = p + aPiece.w * normal_;
}`;

// Colour of what holds liquid, by its saturation: of the bar, or natural, where wet is darker.
export const WET_COLOUR = `
uniform float uNatural; uniform vec4 uBar[11];
vec3 linearOf(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }
vec3 wetColour(vec3 dry, float saturation) {
  int level = saturation < 5e-4 ? 0 : clamp(int(ceil(10.0 * saturation - 1e-3)), 1, 10);
  vec4 bar = uBar[level];
  float wet = smoothstep(0.0, 0.9, saturation);
  return mix(linearOf(mix(vec3(1.0), bar.rgb, bar.a)), dry * mix(1.0, 0.42, wet), uNatural);
}
float wetRoughness(float saturation) { return mix(0.92, mix(0.95, 0.38, smoothstep(0.0, 0.9, saturation)), uNatural); }
`;

const VARYINGS = 'varying vec4 vYarn; varying float vSaturation; varying vec2 vSurface; varying float vOcclusion; varying float vFine;';

export class Yarns {
  readonly group = new THREE.Group();
  readonly mesh: THREE.Mesh;
  readonly points: Float32Array;        // four per point, mm
  readonly saturation: Uint8Array;      // per node: segments, then pores
  readonly firstPoint: number[] = [];   // per yarn, and one past the end
  readonly firstSegment: number[] = [];
  private readonly pointTexture: THREE.DataTexture;
  private readonly saturationTexture: THREE.DataTexture;

  constructor(readonly info: TextileInfo, points: Points, look: YarnLook, sides: number) {
    let segment = 0, point = 0;
    for (let y = 0; y < info.yarn_radius.length; ++y) {
      this.firstPoint.push(point);
      this.firstSegment.push(segment);
      point += info.yarn_points[y]!;
      segment += info.yarn_segments[y]!;
    }
    this.firstPoint.push(point);
    this.firstSegment.push(segment);
    this.points = new Float32Array(4 * padded(point));
    this.saturation = new Uint8Array(padded(info.segments + info.pores));
    this.setPoints(points);
    this.pointTexture = dataTexture(point, 4, this.points);
    this.saturationTexture = dataTexture(info.segments + info.pores, 1, this.saturation);
    this.mesh = new THREE.Mesh(this.pieces(sides), this.material(look, false) as THREE.MeshPhysicalMaterial);
    this.mesh.customDepthMaterial = this.material(look, true);
    this.mesh.frustumCulled = false;
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.group.add(this.mesh);
  }

  setPoints(points: Points): void {
    const { origin, step, xyz } = points;
    this.box.min.fromArray(origin).multiplyScalar(MM);
    this.box.max.fromArray(step).multiplyScalar(65535 * MM).add(this.box.min);
    for (let i = 0; i < xyz.length / 3; ++i)
      for (let k = 0; k < 3; ++k) this.points[4 * i + k] = MM * (origin[k]! + step[k]! * xyz[3 * i + k]!);
    if (this.pointTexture) this.pointTexture.needsUpdate = true;
  }

  // The sheet that it rides on has moved.
  sheet: Sheet | null = null;
  setSheet(nodes: Points): void {
    if (!this.sheet) return;
    this.sheet.place(nodes, this.points);
    this.box.makeEmpty();
    const at = new THREE.Vector3();
    for (let i = 0; i < this.count; ++i) this.box.expandByPoint(at.fromArray(this.points, 4 * i));
    this.pointTexture.needsUpdate = true;
  }
  get count(): number { return this.firstPoint[this.firstPoint.length - 1]!; }

  // Of a soft sheet: no longer where the scene message puts the cloth.
  private readonly bent = { value: 0 };
  get moved(): boolean { return this.bent.value > 0; }
  set moved(on: boolean) { this.bent.value = on ? 1 : 0; }
  readonly box = new THREE.Box3();  // mm, of the points
  saturationChanged(): void { this.saturationTexture.needsUpdate = true; }

  private pieces(sides: number): THREE.InstancedBufferGeometry {
    const { info } = this;
    const rings = info.steps_per_segment;
    const geometry = new THREE.InstancedBufferGeometry();
    const place: number[] = [], index: number[] = [];
    for (let r = 0; r <= rings; ++r) for (let s = 0; s <= sides; ++s) place.push(r, (2 * Math.PI * s) / sides);
    for (let r = 0; r < rings; ++r) for (let s = 0; s < sides; ++s) {
      const a = r * (sides + 1) + s, b = a + sides + 1;
      index.push(a, a + 1, b, a + 1, b + 1, b);
    }
    geometry.setAttribute('aPlace', new THREE.Float32BufferAttribute(place, 2));
    geometry.setAttribute('position', new THREE.Float32BufferAttribute(new Float32Array(place.length / 2 * 3), 3));
    geometry.setAttribute('normal', new THREE.Float32BufferAttribute(new Float32Array(place.length / 2 * 3), 3));
    geometry.setIndex(index);
    const piece = new Float32Array(4 * info.segments), yarn = new Float32Array(4 * info.segments), node = new Float32Array(info.segments);
    let segment = 0;
    for (let y = 0; y < info.yarn_radius.length; ++y) {
      const first = this.firstPoint[y]!, last = this.firstPoint[y + 1]! - 1, colour = info.yarn_colour[y]!;
      for (let s = 0; s < info.yarn_segments[y]!; ++s, ++segment) {
        piece.set([first + s * rings, first, last, MM * info.yarn_radius[y]!], 4 * segment);
        yarn.set([...colour, info.yarn_family[y]!], 4 * segment);
        node[segment] = segment;
      }
    }
    geometry.setAttribute('aPiece', new THREE.InstancedBufferAttribute(piece, 4));
    geometry.setAttribute('aYarn', new THREE.InstancedBufferAttribute(yarn, 4));
    geometry.setAttribute('aNode', new THREE.InstancedBufferAttribute(node, 1));
    geometry.instanceCount = info.segments;
    return geometry;
  }

  private material(look: YarnLook, depthOnly: boolean): THREE.Material {
    const { info } = this;
    const material = depthOnly ? new THREE.MeshDepthMaterial({ depthPacking: THREE.RGBADepthPacking })
      : new THREE.MeshPhysicalMaterial({ roughness: 0.9, metalness: 0, side: THREE.DoubleSide, sheenRoughness: 0.6 });
    const vector = (v: [number, number, number]) => ({ value: new THREE.Vector3(...v) });
    const origin = new THREE.Vector3(...info.origin), normal = new THREE.Vector3(...info.n);
    const uniforms = {
      uPoints: { value: this.pointTexture }, uSaturation: { value: this.saturationTexture },
      uAcross0: vector(info.u), uAcross1: vector(info.v), uNormal: vector(info.n),
      uMiddle: { value: MM * origin.dot(normal) }, uMoved: this.bent, uHalfLoop: { value: info.steps_per_segment },
      uNatural: look.natural, uBar: look.bar, uScale: look.scale, uPixels: look.pixels,
    };
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, uniforms);
      const head = HEAD + (depthOnly ? '' : VARYINGS);
      shader.vertexShader = head + '\n' + shader.vertexShader
        .replace('#include <beginnormal_vertex>', 'vec3 placed, objectNormal; place(placed, objectNormal);')
        .replace('#include <begin_vertex>', depthOnly ? 'vec3 placed, unusedNormal; place(placed, unusedNormal); vec3 transformed = placed;' : `
          vec3 transformed = placed;
          vYarn = aYarn;
          int node = int(aNode + 0.5);
          vSaturation = texelFetch(uSaturation, ivec2(node % ${WIDTH}, node / ${WIDTH}), 0).r * 255.0 / uScale;
          vSurface = vec2(aPlace.x + aPiece.x, aPlace.y);
          // Between the yarns less of the sky is seen: by the height above the middle of the sheet. Of a bent one that is found
          // from the yarn's own waves: half a loop on, it is as far on the other side.
          float i = aPiece.x + aPlace.x;
          vec3 p = pointAt(i), across = mix(uAcross0, uAcross1, aYarn.w);
          vec3 wave = 0.5 * (p - 0.5 * (pointAt(clamp(i - uHalfLoop, aPiece.y, aPiece.z)) + pointAt(clamp(i + uHalfLoop, aPiece.y, aPiece.z))));
          vec3 face = normalize(cross(normalize(pointAt(min(i + uHalfLoop, aPiece.z)) - pointAt(max(i - uHalfLoop, aPiece.y))), across) + 1e-6);
          float bent = abs(dot(placed - p + wave, face)), flat_ = abs(dot(placed, uNormal) - uMiddle);
          float height = mix(flat_, bent, uMoved) / (2.0 * aPiece.w);
          // Yarns of a few pixels are seen at their mean brightness, or the cloth would flicker.
          float pixels = uPixels * projectionMatrix[1][1] * aPiece.w / max(1e-6, -(modelViewMatrix * vec4(placed, 1.0)).z);
          vFine = smoothstep(1.5, 6.0, pixels);
          vOcclusion = mix(0.86, mix(0.4, 1.0, smoothstep(0.0, 0.85, height)), mix(0.25, 1.0, vFine));`);
      if (depthOnly) return;
      shader.fragmentShader = `
        ${WET_COLOUR}
        ${VARYINGS}
      ` + shader.fragmentShader
        .replace('#include <color_fragment>', `
          float wet = smoothstep(0.0, 0.9, vSaturation);
          // The lie of the twist: fine fibres winding around the yarn.
          float winding = sin(5.0 * vSurface.y + 2.6 * vSurface.x) * 0.5 + sin(11.0 * vSurface.y + 5.7 * vSurface.x) * 0.5;
          float fibres = 1.0 + mix(0.035, 0.06, uNatural) * vFine * winding * (1.0 - 0.6 * wet);
          diffuseColor.rgb = wetColour(vYarn.rgb, vSaturation) * fibres * clamp(vOcclusion, 0.3, 1.0);  // at silhouettes it is extrapolated`)
        .replace('#include <roughnessmap_fragment>', `
          float roughnessFactor = wetRoughness(vSaturation);`);
    };
    material.customProgramCacheKey = () => `yarns-${depthOnly}`;
    return material;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    (this.mesh.material as THREE.Material).dispose();
    this.mesh.customDepthMaterial?.dispose();
    this.pointTexture.dispose();
    this.saturationTexture.dispose();
  }
}
