// Where the pores of a textile are. Of a sheet that moves, frames tell where its yarns are: a pore goes with the points of
// the yarns around it.
import type { Points } from './protocol';
import { MM, type Yarns } from './yarns';

const AROUND = 4;  // points that carry a pore

export class Pores {
  private readonly flat: Float32Array;   // mm, three per pore, where the geometry of the scene has them
  private readonly start: Float32Array;  // the yarns' points then, four numbers each
  private carriers: Uint32Array | null = null;

  constructor(points: Points, private readonly yarns: Yarns) {
    const { origin, step, xyz } = points;
    this.flat = Float32Array.from(xyz, (x, i) => MM * (origin[i % 3]! + step[i % 3]! * x));
    this.start = yarns.points.slice();
  }

  get count(): number { return this.flat.length / 3; }

  // mm, three per pore.
  places(): Float32Array {
    if (!this.yarns.moved) return this.flat;
    this.carriers ??= this.findCarriers();
    const now = this.yarns.points, places = this.flat.slice();
    for (let i = 0; i < this.count; ++i)
      for (let k = 0; k < AROUND; ++k) {
        const p = 4 * this.carriers[AROUND * i + k]!;
        for (let axis = 0; axis < 3; ++axis) places[3 * i + axis]! += (now[p + axis]! - this.start[p + axis]!) / AROUND;
      }
    return places;
  }

  // The nearest point on each of four sides, through bins of the pitch: without a side to it a pore takes its nearest again.
  private findCarriers(): Uint32Array {
    const { start, flat } = this, { u, v, pitch } = this.yarns.info;
    const points = this.yarns.firstPoint[this.yarns.firstPoint.length - 1]!, size = MM * Math.max(...pitch);
    const along = (axis: number[], a: Float32Array, at: number) => axis[0]! * a[at]! + axis[1]! * a[at + 1]! + axis[2]! * a[at + 2]!;
    const bins = new Map<string, number[]>();
    const key = (x: number, y: number) => `${Math.floor(x)} ${Math.floor(y)}`;
    for (let p = 0; p < points; ++p) {
      const at = key(along(u, start, 4 * p) / size, along(v, start, 4 * p) / size), bin = bins.get(at);
      if (bin) bin.push(p); else bins.set(at, [p]);
    }
    const found = new Uint32Array(AROUND * this.count);
    for (let i = 0; i < this.count; ++i) {
      const x = along(u, flat, 3 * i), y = along(v, flat, 3 * i), best = [-1, -1, -1, -1], nearest = [Infinity, Infinity, Infinity, Infinity];
      for (let a = -1; a <= 1; ++a)
        for (let b = -1; b <= 1; ++b)
          for (const p of bins.get(key(x / size + a, y / size + b)) ?? []) {
            const dx = along(u, start, 4 * p) - x, dy = along(v, start, 4 * p) - y, d = dx * dx + dy * dy;
            const side = Math.abs(dx) > Math.abs(dy) ? (dx > 0 ? 0 : 1) : dy > 0 ? 2 : 3;
            if (d < nearest[side]!) nearest[side] = d, best[side] = p;
          }
      const closest = best[nearest.indexOf(Math.min(...nearest))]!;
      for (let k = 0; k < AROUND; ++k) found[AROUND * i + k] = Math.max(0, best[k]! >= 0 ? best[k]! : closest);
    }
    return found;
  }
}
