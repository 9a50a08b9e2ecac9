// The soft sheet that a textile's yarns ride on: from where its nodes are, where the points of the yarns are.
// position = sum of weights x corners + height x n, n the nodes' normals (mean of the triangles around, by area) mixed alike.
import type { Points } from './protocol';
import { MM } from './yarns';

export class Sheet {
  private readonly corners: Uint32Array;   // of each point's triangle, three numbers of nodes
  private readonly weights: Float32Array;  // of these
  private readonly heights: Float32Array;  // mm

  constructor(private readonly triangles: Uint32Array, count: number, carried: DataView) {
    this.corners = new Uint32Array(3 * count);
    this.weights = new Float32Array(3 * count);
    this.heights = new Float32Array(count);
    for (let i = 0; i < count; ++i) {
      const at = 12 * i, triangle = carried.getUint32(at, true);
      const second = carried.getUint16(at + 4, true) / 65535, third = carried.getUint16(at + 6, true) / 65535;
      for (let k = 0; k < 3; ++k) this.corners[3 * i + k] = triangles[3 * triangle + k]!;
      this.weights.set([1 - second - third, second, third], 3 * i);
      this.heights[i] = MM * carried.getFloat32(at + 8, true);
    }
  }

  // Writes the points, four numbers each, in mm.
  place({ origin, step, xyz }: Points, to: Float32Array): void {
    const nodes = Float32Array.from(xyz, (x, i) => MM * (origin[i % 3]! + step[i % 3]! * x)), normals = this.normals(nodes);
    for (let i = 0; i < this.heights.length; ++i) {
      let x = 0, y = 0, z = 0, nx = 0, ny = 0, nz = 0;
      for (let k = 3 * i; k < 3 * i + 3; ++k) {
        const w = this.weights[k]!, node = 3 * this.corners[k]!;
        x += w * nodes[node]!, y += w * nodes[node + 1]!, z += w * nodes[node + 2]!;
        nx += w * normals[node]!, ny += w * normals[node + 1]!, nz += w * normals[node + 2]!;
      }
      const out = this.heights[i]! / (Math.hypot(nx, ny, nz) || 1);
      to[4 * i] = x + out * nx, to[4 * i + 1] = y + out * ny, to[4 * i + 2] = z + out * nz;
    }
  }

  private normals(nodes: Float32Array): Float32Array {
    const normals = new Float32Array(nodes.length), { triangles } = this;
    for (let t = 0; t < triangles.length; t += 3) {
      const a = 3 * triangles[t]!, b = 3 * triangles[t + 1]!, c = 3 * triangles[t + 2]!;
      const ux = nodes[b]! - nodes[a]!, uy = nodes[b + 1]! - nodes[a + 1]!, uz = nodes[b + 2]! - nodes[a + 2]!;
      const vx = nodes[c]! - nodes[a]!, vy = nodes[c + 1]! - nodes[a + 1]!, vz = nodes[c + 2]! - nodes[a + 2]!;
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      for (const k of [a, b, c]) normals[k]! += nx, normals[k + 1]! += ny, normals[k + 2]! += nz;
    }
    for (let k = 0; k < normals.length; k += 3) {
      const size = Math.hypot(normals[k]!, normals[k + 1]!, normals[k + 2]!) || 1;
      normals[k]! /= size, normals[k + 1]! /= size, normals[k + 2]! /= size;
    }
    return normals;
  }
}
