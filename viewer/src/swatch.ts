// One swatch on the page: its scene message, its yarns, liquid and solids in a three.js scene, and its rows.
import * as THREE from 'three';
import { applyChanges, type Frame, type HelloMessage, type Points, type SceneMessage } from './protocol';
import { Cloth } from './cloth';
import { Liquid } from './liquid';
import { Series } from './series';
import { solidMesh } from './solids';
import { Pores } from './pores';
import { Sheet } from './sheet';
import { MM, Yarns, type YarnLook } from './yarns';

function boxOf({ origin, step, xyz }: Points): THREE.Box3 {
  if (xyz.length === 0) return new THREE.Box3();
  const low = new THREE.Vector3(...origin).multiplyScalar(MM);
  return new THREE.Box3(low, new THREE.Vector3(...step).multiplyScalar(65535 * MM).add(low));
}

export class Swatch {
  readonly scene = new THREE.Scene();
  yarns: Yarns[] = [];
  cloths: Cloth[] = [];                // owners after the textiles
  liquid: Liquid | null = null;
  pores: Pores[] = [];                 // per textile
  readonly series: Series;
  message: SceneMessage | null = null;
  generation = 0;
  flags = 0;
  values: Float64Array = new Float64Array();
  frames = 0;
  frameBytes = 0;
  private readonly solidBounds = new THREE.Box3();
  readonly startingLiquid = new THREE.Box3();
  shadowsStale = true;
  private readonly things = new THREE.Group();
  private readonly sun = new THREE.DirectionalLight(0xffffff, 2.5);

  constructor(hello: HelloMessage, private readonly look: YarnLook) {
    this.series = new Series(hello.columns);
    this.scene.add(this.things, new THREE.HemisphereLight(0xffffff, 0x9a9a9c, 1.5), this.sun, this.sun.target);
    const fill = new THREE.DirectionalLight(0xdbe8ff, 0.5);
    fill.position.set(-1, 0.6, 0.5);
    this.scene.add(fill);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.radius = 5;
  }

  get textiles() { return this.message?.textiles ?? []; }

  // Where the cloths are now; empty when there are none.
  get clothBounds(): THREE.Box3 {
    const box = new THREE.Box3();
    for (const yarns of this.yarns) box.union(yarns.box);
    for (const cloth of this.cloths) box.union(cloth.mesh.geometry.boundingBox!);
    return box;
  }

  // Cloths and solids.
  get bounds(): THREE.Box3 {
    const box = this.clothBounds.union(this.solidBounds);
    return box.isEmpty() ? box.set(new THREE.Vector3(-10, -10, 0), new THREE.Vector3(10, 10, 10)) : box;
  }

  begin(message: SceneMessage): void {
    this.message = message;
    this.generation = message.generation;
    this.frames = this.frameBytes = 0;
    this.series.load(message.history, message.replay);
    this.values = new Float64Array(this.series.columns.length);
  }

  take(frame: Frame, sides: number): void {
    if (frame.geometry) return this.build(frame, sides);
    if (frame.generation !== this.generation) return;
    this.flags = frame.flags;
    this.values = frame.values;
    this.series.add(frame.values);
    ++this.frames;
    this.frameBytes += frame.bytes;
    for (const section of frame.sections) {
      if (section.kind === 'particles') {
        this.liquid?.set(section.points);
        if (this.frames === 1) this.startingLiquid.copy(boxOf(section.points));
        continue;
      }
      const yarns = 'owner' in section ? this.yarns[section.owner] ?? this.cloths[section.owner - this.textiles.length] : undefined;
      if (!yarns) continue;
      if (section.kind === 'saturations') yarns.saturation.set(section.values), yarns.saturationChanged();
      else if (section.kind === 'changes') applyChanges(yarns.saturation, section.bytes, section.count), yarns.saturationChanged();
      else if (section.kind === 'yarns') yarns.setPoints(section.points), this.shadowsStale = true, yarns.moved = true;
      else if (section.kind === 'sheet' && yarns instanceof Yarns) yarns.setSheet(section.points), this.shadowsStale = true, yarns.moved = true;
    }
  }

  private build(frame: Frame, sides: number): void {
    const message = this.message;
    if (!message || frame.generation !== message.generation) return;
    this.clear();
    const meshes = new Map<number, { vertices: Float32Array; triangles: Uint32Array }>();
    const sheets = new Map<number, Uint32Array>(), places = new Map<number, Float32Array>(), nodes = new Map<number, Points>();
    for (const section of frame.sections) if (section.kind === 'cloth places') places.set(section.owner, section.values);
    for (const section of frame.sections) {
      if (section.kind === 'yarns' && section.owner >= message.textiles.length) {
        nodes.set(section.owner, section.points);
      } else if (section.kind === 'cloth triangles') {
        const i = section.owner - message.textiles.length;
        const cloth = new Cloth(message.cloths[i]!, nodes.get(section.owner)!, section.values, places.get(section.owner)!, this.look);
        this.cloths[i] = cloth;
        this.things.add(cloth.mesh);
      } else if (section.kind === 'yarns') {
        const info = message.textiles[section.owner]!;
        const yarns = new Yarns(info, section.points, this.look, info.segments > 8000 ? Math.min(sides, 8) : sides);
        this.yarns[section.owner] = yarns;
        this.things.add(yarns.group);
      } else if (section.kind === 'pores') {
        this.pores[section.owner] = new Pores(section.points, this.yarns[section.owner]!);
      } else if (section.kind === 'sheet triangles') {
        sheets.set(section.owner, section.values);
      } else if (section.kind === 'carried') {
        this.yarns[section.owner]!.sheet = new Sheet(sheets.get(section.owner)!, section.count, section.data);
      } else if (section.kind === 'vertices') {
        meshes.set(section.owner, { vertices: section.values, triangles: new Uint32Array() });
      } else if (section.kind === 'triangles') {
        const mesh = meshes.get(section.owner);
        if (mesh) mesh.triangles = section.values;
      }
    }
    this.solidBounds.makeEmpty();
    this.startingLiquid.makeEmpty();
    this.shadowsStale = true;
    const extent = this.bounds.getSize(new THREE.Vector3()).length();
    message.solids.forEach((solid, i) => {
      const mesh = solidMesh(solid, extent, meshes.get(i));
      this.things.add(mesh);
      if (solid.form !== 'plane') this.solidBounds.expandByObject(mesh);
    });
    this.liquid = new Liquid(message.liquid.spacing || 1e-4);
    this.things.add(this.liquid.balls);
  }

  // The sun over what is there now.
  light(): void {
    const bounds = this.bounds, centre = bounds.getCenter(new THREE.Vector3()), size = bounds.getSize(new THREE.Vector3()).length();
    this.sun.position.copy(centre).add(new THREE.Vector3(0.55, -0.65, 1.1).multiplyScalar(size));
    this.sun.target.position.copy(centre);
    const camera = this.sun.shadow.camera, half = 0.62 * size;
    camera.left = camera.bottom = -half;
    camera.right = camera.top = half;
    camera.near = 0.1 * size;
    camera.far = 3 * size;
    camera.updateProjectionMatrix();
    this.sun.shadow.normalBias = 0.0012 * size;  // two texels of the shadow map
  }

  value(name: string): number { return this.values[this.series.index(name)] ?? 0; }

  // Particles as balls, or hidden because LiquidSurface draws them.
  showBalls(on: boolean): void {
    if (!this.liquid) return;
    this.liquid.balls.visible = on;
    this.liquid.forSurface(!on, this.message?.liquid.spacing ?? 1e-4);
  }

  private clear(): void {
    for (const thing of [...this.yarns, ...this.cloths]) thing.dispose();
    this.liquid?.dispose();
    this.things.traverse((thing) => { if (thing instanceof THREE.Mesh && thing.geometry) thing.geometry.dispose(); });
    this.things.clear();
    this.yarns = [];
    this.cloths = [];
    this.pores = [];
    this.liquid = null;
  }

  dispose(): void { this.clear(); }
}
