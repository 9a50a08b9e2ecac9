// A soft sheet whose nodes are cells of liquid, as a surface that moves with its nodes and darkens with what they hold.
import * as THREE from 'three';
import type { ClothInfo, Points } from './protocol';
import { MM, WET_COLOUR, type YarnLook } from './yarns';

const THREAD = 1.2;  // mm: repeat of the drawn weave, coarser than any real one so that it is seen

export class Cloth {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshPhysicalMaterial>;
  readonly saturation: Uint8Array;
  moved = false;

  constructor(readonly info: ClothInfo, points: Points, triangles: Uint32Array, places: Float32Array, look: YarnLook) {
    this.saturation = new Uint8Array(info.nodes);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * info.nodes), 3).setUsage(THREE.DynamicDrawUsage));
    geometry.setAttribute('aSaturation', new THREE.BufferAttribute(this.saturation, 1).setUsage(THREE.DynamicDrawUsage));
    geometry.setAttribute('aPlace', new THREE.BufferAttribute(Float32Array.from(places, (x) => MM * x), 2));
    geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
    this.mesh = new THREE.Mesh(geometry, this.material(look));
    this.mesh.frustumCulled = false;
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.setPoints(points);
  }

  get points(): Float32Array { return this.mesh.geometry.getAttribute('position').array as Float32Array; }

  setPoints(points: Points): void {
    const { origin, step, xyz } = points, to = this.points;
    for (let i = 0; i < xyz.length; ++i) to[i] = MM * (origin[i % 3]! + step[i % 3]! * xyz[i]!);
    const geometry = this.mesh.geometry;
    geometry.getAttribute('position').needsUpdate = true;
    geometry.computeVertexNormals();
    geometry.computeBoundingBox();
    geometry.computeBoundingSphere();
  }

  saturationChanged(): void { this.mesh.geometry.getAttribute('aSaturation').needsUpdate = true; }

  private material(look: YarnLook): THREE.MeshPhysicalMaterial {
    const material = new THREE.MeshPhysicalMaterial({ roughness: 0.9, metalness: 0, side: THREE.DoubleSide });
    const uniforms = { uNatural: look.natural, uBar: look.bar, uScale: look.scale, uDry: { value: new THREE.Vector3(...this.info.colour) } };
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, uniforms);
      shader.vertexShader = `attribute float aSaturation; attribute vec2 aPlace; uniform float uScale; varying float vSaturation; varying vec2 vPlace;\n` +
        shader.vertexShader.replace('#include <begin_vertex>', '#include <begin_vertex>\nvSaturation = aSaturation / uScale; vPlace = aPlace;');
      shader.fragmentShader = `uniform vec3 uDry; varying float vSaturation; varying vec2 vPlace; ${WET_COLOUR}` + shader.fragmentShader
        .replace('#include <color_fragment>', `
          // Plain weave, where a thread is wider than a pixel.
          vec2 thread = vPlace / ${THREAD.toFixed(2)};
          float near = 1.0 - smoothstep(0.08, 0.25, max(fwidth(thread.x), fwidth(thread.y)));
          vec2 s = sin(6.2832 * thread);
          float over = 0.5 + 0.5 * s.x * s.y, weave = 1.0 - 0.10 * near * (1.0 - over);
          diffuseColor.rgb = wetColour(uDry, vSaturation) * weave;`)
        .replace('#include <roughnessmap_fragment>', 'float roughnessFactor = wetRoughness(vSaturation);');
    };
    material.customProgramCacheKey = () => 'cloth';
    return material;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
