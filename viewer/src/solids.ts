// The fixed solids of a scene.
import * as THREE from 'three';
import type { SolidInfo } from './protocol';
import { MM } from './yarns';

export function solidMesh(solid: SolidInfo, extent: number, mesh?: { vertices: Float32Array; triangles: Uint32Array }): THREE.Mesh {
  const material = new THREE.MeshPhysicalMaterial({ color: new THREE.Color().setRGB(...solid.colour), roughness: 0.55, metalness: 0, side: THREE.DoubleSide });
  const made = new THREE.Mesh(shape(solid, extent, mesh), material);
  place(made, solid);
  made.castShadow = solid.form !== 'plane';
  made.receiveShadow = true;
  return made;
}

function shape(solid: SolidInfo, extent: number, mesh?: { vertices: Float32Array; triangles: Uint32Array }): THREE.BufferGeometry {
  switch (solid.form) {
    case 'plane': return new THREE.PlaneGeometry(3 * extent, 3 * extent);
    case 'box': return new THREE.BoxGeometry(...(solid.size.map((x) => MM * x) as [number, number, number]));
    case 'sphere': return new THREE.SphereGeometry(MM * solid.radius, 48, 32);
    case 'cylinder': return new THREE.CylinderGeometry(MM * solid.radius, MM * solid.radius, MM * solid.height, 64);
    case 'cone': return new THREE.ConeGeometry(MM * solid.radius, MM * solid.height, 64);
    case 'mesh': {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute((mesh?.vertices ?? new Float32Array()).map((x) => MM * x), 3));
      geometry.setIndex(new THREE.BufferAttribute(mesh?.triangles ?? new Uint32Array(), 1));
      geometry.computeVertexNormals();
      return geometry;
    }
  }
}

function place(mesh: THREE.Mesh, solid: SolidInfo): void {
  if (solid.form === 'plane') {
    mesh.position.set(...solid.point).multiplyScalar(MM);
    mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), new THREE.Vector3(...solid.normal).normalize());
  } else if (solid.form === 'box' || solid.form === 'sphere') {
    mesh.position.set(...solid.centre).multiplyScalar(MM);
  } else if (solid.form === 'cylinder' || solid.form === 'cone') {
    const axis = new THREE.Vector3(...solid.axis).normalize();
    mesh.position.set(...solid.base).addScaledVector(axis, solid.height / 2).multiplyScalar(MM);
    mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), axis);
  }
}
