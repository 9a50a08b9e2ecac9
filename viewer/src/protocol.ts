// The wire, as docs/live_protocol.md describes it: JSON both ways for what happens seldom, one binary form for frames.

export const PROTOCOL = 1;

export const Flag = { running: 1, ended: 2, resting: 4, replay: 8, recording: 16, failed: 32 } as const;

export type Vec3 = [number, number, number];

export interface Problem { file: string; line: number; column: number; key: string; message: string }

export interface ControlRow {
  path: string;
  kind: 'group' | 'choice' | 'number' | 'integer' | 'boolean' | 'text';
  help: string;
  effect: 'next step' | 'restart' | 'never';
  length?: number;
  unit?: string;
  text?: string;
  low?: number;
  high?: number;
  above_low?: boolean;
  choices?: string[];
  numbers?: number[];
  stands_for?: number;
}

export interface TextileInfo {
  name: string;
  size: [number, number];
  thickness: number;
  pitch: [number, number];
  origin: Vec3; u: Vec3; v: Vec3; n: Vec3;
  steps_per_segment: number;
  segments: number;
  pores: number;
  yarn_radius: number[];
  yarn_colour: Vec3[];
  yarn_family: number[];
  yarn_segments: number[];
  yarn_points: number[];
}

// A sheet whose nodes are cells of liquid; the owner of its sections comes after the textiles.
export interface ClothInfo { name: string; colour: Vec3; nodes: number }

export type SolidInfo = { name: string; colour: Vec3; contact_angle: number } & (
  | { form: 'plane'; point: Vec3; normal: Vec3 }
  | { form: 'box'; centre: Vec3; size: Vec3 }
  | { form: 'sphere'; centre: Vec3; radius: number }
  | { form: 'cylinder' | 'cone'; base: Vec3; axis: Vec3; radius: number; height: number }
  | { form: 'mesh' });

export interface SceneMessage {
  type: 'scene';
  swatch: number;
  generation: number;
  title: string;
  replay: boolean;
  folder: string;
  duration: number;
  gravity: Vec3;
  liquid: { name: string; spacing: number; particle_mass: number; density: number };
  textiles: TextileInfo[];
  cloths: ClothInfo[];
  solids: SolidInfo[];
  controls: ControlRow[];
  history: (number | null)[][];
}

export interface InspectMessage {
  type: 'inspect';
  textile: number; node: number; name: string; place: Vec3;
  kind: 'warp' | 'weft' | 'pore' | 'cell';
  saturation: number; liquid_kg: number; capacity_kg?: number; pressure?: number; dry_kg?: number; speed?: number;
  yarn?: number; segment?: number; fibre?: string; radius?: number; contact_angle?: number; regain?: number; sorbed_kg?: number;
  throat?: number; opening?: [number, number];
}

export interface HelloMessage {
  type: 'hello'; protocol: number; viewer: number; version: string;
  columns: string[]; step_bounds: string[]; saturation_scale: number;
  bar: [number, number, number, number][];
  gallery: { id: string; title: string }[];
  replay: boolean; speed_limit: number; swatches: number;
}

export type ServerMessage =
  | HelloMessage
  | SceneMessage
  | InspectMessage
  | { type: 'controls'; holder: number; viewers: number }
  | { type: 'changed'; swatch: number; viewer: number; set: string[]; step: number; time: number; duration: number; controls: ControlRow[] }
  | { type: 'error'; swatch: number; about: string; problems: Problem[] }
  | { type: 'notice'; swatch: number; message: string }
  | { type: 'speed'; swatch: number; limit: number }
  | { type: 'swatches'; count: number }
  | { type: 'scene_text'; swatch: number; text: string }
  | { type: 'history'; swatch: number; generation: number; rows: (number | null)[][] }
  | { type: 'done'; swatch: number; ask: number; arrived: number; step: number; time: number };

// `every`: each stands for so many, the others are not sent.
export interface Points { origin: Float32Array; step: Float32Array; xyz: Uint16Array; every: number }

export type Section =
  | { kind: 'particles'; points: Points }
  | { kind: 'saturations'; owner: number; values: Uint8Array }
  | { kind: 'changes'; owner: number; count: number; bytes: Uint8Array }
  | { kind: 'yarns'; owner: number; points: Points }
  | { kind: 'pores'; owner: number; points: Points }
  | { kind: 'vertices'; owner: number; values: Float32Array }
  | { kind: 'triangles'; owner: number; values: Uint32Array }
  | { kind: 'cloth triangles'; owner: number; values: Uint32Array }
  | { kind: 'cloth places'; owner: number; values: Float32Array }
  | { kind: 'sheet'; owner: number; points: Points }
  | { kind: 'sheet triangles'; owner: number; values: Uint32Array }
  | { kind: 'carried'; owner: number; count: number; data: DataView };

export interface Frame {
  swatch: number; geometry: boolean; generation: number; number: number; flags: number;
  values: Float64Array;
  sections: Section[];
  bytes: number;
}

const MAGIC = 0x46424d49;  // "IMBF"

export function decodeFrame(buffer: ArrayBuffer): Frame {
  const view = new DataView(buffer);
  if (view.getUint32(0, true) !== MAGIC || view.getUint16(4, true) !== PROTOCOL) throw new Error('not a frame of this protocol');
  const valueCount = view.getUint32(20, true);
  const sectionCount = view.getUint16(18, true);
  const values = new Float64Array(buffer.slice(24, 24 + 8 * valueCount));
  const sections: Section[] = [];
  let at = 24 + 8 * valueCount;
  for (let i = 0; i < sectionCount; ++i) {
    const kind = view.getUint8(at), owner = view.getUint8(at + 1), every = Math.max(1, view.getUint16(at + 2, true));
    const count = view.getUint32(at + 4, true), bytes = view.getUint32(at + 8, true);
    const from = at + 12;
    const points = (): Points => ({
      origin: new Float32Array(buffer.slice(from, from + 12)),
      step: new Float32Array(buffer.slice(from + 12, from + 24)),
      xyz: new Uint16Array(buffer, from + 24, 3 * count), every,
    });
    switch (kind) {
      case 1: sections.push({ kind: 'particles', points: points() }); break;
      case 2: sections.push({ kind: 'saturations', owner, values: new Uint8Array(buffer, from, count) }); break;
      case 3: sections.push({ kind: 'changes', owner, count, bytes: new Uint8Array(buffer, from, bytes) }); break;
      case 4: sections.push({ kind: 'yarns', owner, points: points() }); break;
      case 5: sections.push({ kind: 'pores', owner, points: points() }); break;
      case 6: sections.push({ kind: 'vertices', owner, values: new Float32Array(buffer.slice(from, from + bytes)) }); break;
      case 7: sections.push({ kind: 'triangles', owner, values: new Uint32Array(buffer.slice(from, from + bytes)) }); break;
      case 8: sections.push({ kind: 'cloth triangles', owner, values: new Uint32Array(buffer.slice(from, from + bytes)) }); break;
      case 9: sections.push({ kind: 'cloth places', owner, values: new Float32Array(buffer.slice(from, from + bytes)) }); break;
      case 10: sections.push({ kind: 'sheet', owner, points: points() }); break;
      case 11: sections.push({ kind: 'sheet triangles', owner, values: new Uint32Array(buffer.slice(from, from + bytes)) }); break;
      case 12: sections.push({ kind: 'carried', owner, count, data: new DataView(buffer, from, bytes) }); break;
      default: break;  // of a later version: left out
    }
    at = from + ((bytes + 3) & ~3);
  }
  return {
    swatch: view.getUint8(6), geometry: view.getUint8(7) === 1,
    generation: view.getUint32(8, true), number: view.getUint32(12, true), flags: view.getUint16(16, true),
    values, sections, bytes: buffer.byteLength,
  };
}

// Applies the changed nodes: gaps as LEB128, then the new value.
export function applyChanges(saturation: Uint8Array, bytes: Uint8Array, count: number): void {
  let at = 0, node = 0;
  for (let i = 0; i < count; ++i) {
    let gap = 0, shift = 0, byte: number;
    do {
      byte = bytes[at++] ?? 0;
      gap += (byte & 0x7f) * 2 ** shift;
      shift += 7;
    } while (byte & 0x80);
    node += gap;
    saturation[node] = bytes[at++] ?? 0;
  }
}

export type ClientMessage = { type: string; swatch?: number } & Record<string, unknown>;
