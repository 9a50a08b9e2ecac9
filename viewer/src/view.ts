// The 3-D view: one renderer, one camera, a part of the canvas per swatch. Draws only when something has changed, so
// that a still page costs nothing and a weak machine's processor is left to the simulation.
import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { LiquidSurface } from './liquid_surface';
import { roundLength } from './text';
import type { Swatch } from './swatch';

export type Quality = 'fine' | 'plain';

export interface Hit { swatch: number; textile: number; node: number; place: THREE.Vector3 }

export class View {
  readonly camera = new THREE.PerspectiveCamera(32, 1, 0.1, 1e5);
  readonly orbit: OrbitControls;
  quality: Quality = 'fine';
  draws = 0;
  drawMs = 0;
  hold = false;  // draws only when drawNow() is called: films and measures
  private readonly renderer: THREE.WebGLRenderer;
  private surface: LiquidSurface | null = null;
  private dirty = true;
  private cut: number | null = null;
  private readonly plane = new THREE.Plane(new THREE.Vector3(0, 1, 0), 0);
  private dark = false;
  private keepPicture: ((canvas: HTMLCanvasElement) => void) | null = null;
  readonly software: boolean;

  constructor(readonly canvas: HTMLCanvasElement, private readonly swatches: () => Swatch[], private readonly drawn: () => void) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, powerPreference: 'high-performance' });
    const gl = this.renderer.getContext(), info = gl.getExtension('WEBGL_debug_renderer_info');
    const name = info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '';
    this.software = /swiftshader|llvmpipe|software/i.test(name);
    this.renderer.autoClear = false;
    this.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    this.renderer.shadowMap.autoUpdate = false;  // drawn anew only when what casts them has moved
    this.camera.up.set(0, 0, 1);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.enableDamping = false;
    this.orbit.zoomToCursor = true;
    this.orbit.addEventListener('change', () => this.touch());
    new ResizeObserver(() => this.touch()).observe(canvas);
    const loop = () => { if (this.dirty && !this.hold) this.drawNow(); requestAnimationFrame(loop); };
    requestAnimationFrame(loop);
  }

  touch(): void { this.dirty = true; }

  setQuality(quality: Quality): void {
    this.quality = quality;
    if (quality === 'plain') { this.surface?.dispose(); this.surface = null; }
    else this.surface ??= new LiquidSurface();
    this.renderer.shadowMap.enabled = quality === 'fine';
    for (const swatch of this.swatches()) swatch.shadowsStale = true;
    this.renderer.setPixelRatio(quality === 'fine' ? Math.min(devicePixelRatio, 2) : 1);
    for (const swatch of this.swatches())
      swatch.scene.traverse((thing) => { if (thing instanceof THREE.Mesh) (thing.material as THREE.Material).needsUpdate = true; });
    this.touch();
  }

  setDark(dark: boolean): void { this.dark = dark; this.touch(); }

  // -1 .. 1 across the cloth; null: whole.
  setSection(place: number | null): void { this.cut = place; this.touch(); }

  // Cloths and solids of all swatches, and apart from them what liquid there was at the start.
  private boxes(): THREE.Box3[] {
    const boxes: THREE.Box3[] = [];
    for (const swatch of this.swatches()) {
      boxes.push(swatch.bounds, swatch.startingLiquid);
    }
    const some = boxes.filter((box) => !box.isEmpty());
    return some.length > 0 ? some : [new THREE.Box3(new THREE.Vector3(-10, -10, -1), new THREE.Vector3(10, 10, 1))];
  }

  private bounds(): THREE.Box3 { return this.boxes().reduce((all, box) => all.union(box), new THREE.Box3()); }

  fit(direction: 'free' | 'top' | 'side' | 'keep' = 'free'): void {
    const from = direction === 'top' ? new THREE.Vector3(0, -0.001, 1) : direction === 'side' ? new THREE.Vector3(0, -1, 0.06)
      : direction === 'keep' ? this.camera.position.clone().sub(this.orbit.target).normalize() : new THREE.Vector3(0.32, -0.92, 0.78);
    from.normalize();
    const area = this.area(0);
    const bar = this.swatches().length > 1 ? 0 : this.margin;  // one view lies under the colour bar: what it shows keeps off
    const half = Math.tan((this.camera.fov * Math.PI) / 360), wide = 0.94 * half * ((area.z - bar) / Math.max(1, area.w)), high = 0.8 * half;
    const right = new THREE.Vector3().crossVectors(this.camera.up, from).normalize(), up = new THREE.Vector3().crossVectors(from, right);
    const corners: THREE.Vector3[] = [];
    for (const { min, max } of this.boxes())
      for (let k = 0; k < 8; ++k) corners.push(new THREE.Vector3(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z));
    // As near as every corner stays inside the picture; then the middle of what is seen to the middle of the picture.
    const centre = this.bounds().getCenter(new THREE.Vector3());
    let distance = 1;
    for (let pass = 0; pass < 4; ++pass) {
      distance = 0.5;
      for (const corner of corners) {
        const c = corner.clone().sub(centre);
        distance = Math.max(distance, c.dot(from) + Math.max(Math.abs(c.dot(right)) / wide, Math.abs(c.dot(up)) / high));
      }
      for (const axis of [right, up]) {
        let low = Infinity, top = -Infinity;
        for (const corner of corners) {
          const c = corner.clone().sub(centre), at = c.dot(axis) / (distance - c.dot(from));
          low = Math.min(low, at);
          top = Math.max(top, at);
        }
        centre.addScaledVector(axis, 0.5 * (low + top) * distance);
      }
    }
    const millimetre = area.w / (2 * distance * half);  // pixels
    const reach = Math.max(...corners.map((corner) => { const c = corner.clone().sub(centre); return (c.dot(right) * distance) / (distance - c.dot(from)); }));
    centre.addScaledVector(right, Math.min(0.5 * bar, Math.max(0, reach * millimetre - (0.5 * area.z - bar))) / millimetre);
    this.orbit.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(from, distance);
    this.camera.near = distance / 200;
    this.camera.far = distance * 30;
    this.orbit.minDistance = 0.01 * distance;
    this.orbit.maxDistance = 8 * distance;
    this.orbit.update();
    this.touch();
  }

  turn(azimuth: number, elevation: number): void {
    const offset = this.camera.position.clone().sub(this.orbit.target), s = new THREE.Spherical();
    const q = new THREE.Quaternion().setFromUnitVectors(this.camera.up, new THREE.Vector3(0, 1, 0));
    s.setFromVector3(offset.applyQuaternion(q));
    s.theta += azimuth;
    s.phi = Math.min(Math.PI - 0.01, Math.max(0.01, s.phi + elevation));
    this.camera.position.copy(this.orbit.target).add(new THREE.Vector3().setFromSpherical(s).applyQuaternion(q.invert()));
    this.orbit.update();
    this.touch();
  }

  zoom(factor: number): void {
    this.camera.position.sub(this.orbit.target).multiplyScalar(factor).add(this.orbit.target);
    this.orbit.update();
    this.touch();
  }

  // CSS pixels at the right that two views leave to the colour bar; over one view's corner it lies.
  margin = 0;

  // The part of the canvas of a swatch: x, y from below, width, height in CSS pixels.
  area(index: number): THREE.Vector4 {
    const n = Math.max(1, this.swatches().length), width = (this.canvas.clientWidth - (n > 1 ? this.margin : 0)) / n;
    return new THREE.Vector4(Math.round(index * width), 0, Math.round(width), this.canvas.clientHeight);
  }

  drawNow(): void {
    this.dirty = false;
    const start = performance.now();
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (width === 0 || height === 0) return;
    const size = this.renderer.getSize(new THREE.Vector2());
    if (size.x !== width || size.y !== height) this.renderer.setSize(width, height, false);
    const ground = getComputedStyle(document.documentElement).getPropertyValue('--ground').trim() || '#ffffff';
    this.renderer.setRenderTarget(null);
    this.renderer.setScissorTest(false);
    this.renderer.setClearColor(new THREE.Color(ground), 1);
    this.renderer.clear();
    this.section();
    this.swatches().forEach((swatch, index) => this.drawSwatch(swatch, index, new THREE.Color(ground)));
    this.keepPicture?.(this.canvas);
    this.keepPicture = null;
    ++this.draws;
    this.drawMs = performance.now() - start;
    this.drawn();
  }

  private drawSwatch(swatch: Swatch, index: number, ground: THREE.Color): void {
    const area = this.area(index);
    this.camera.aspect = area.z / area.w;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    swatch.scene.background = ground;
    const liquid = swatch.liquid;
    if (liquid) {
      liquid.uniforms.uPixels.value = area.w * this.renderer.getPixelRatio();
      liquid.uniforms.uProjection.value.copy(this.camera.projectionMatrix);
      const cut = this.plane.clone().applyMatrix4(this.camera.matrixWorldInverse);
      if (this.cut === null) liquid.uniforms.uCut.value.set(0, 0, 0, 1);
      else liquid.uniforms.uCut.value.set(cut.normal.x, cut.normal.y, cut.normal.z, cut.constant);
    }
    if (swatch.shadowsStale) swatch.light(), this.renderer.shadowMap.needsUpdate = true, swatch.shadowsStale = false;
    const smooth = this.surface !== null && liquid !== null && liquid.count > 0;
    swatch.showBalls(!smooth);
    if (smooth) return this.surface!.render(this.renderer, swatch.scene, this.camera, liquid, area, this.dark);
    this.renderer.setViewport(area);
    this.renderer.setScissor(area);
    this.renderer.setScissorTest(true);
    this.renderer.render(swatch.scene, this.camera);
  }

  private section(): void {
    if (this.cut === null) { this.renderer.clippingPlanes = []; return; }
    // Across the cloth: a sheet that hangs facing the front is cut from top to bottom, all others along the front.
    const box = this.swatches().reduce((all, swatch) => all.union(swatch.clothBounds), new THREE.Box3());
    const bounds = box.isEmpty() ? this.bounds() : box, size = bounds.getSize(new THREE.Vector3());
    const axis = size.y < 0.3 * size.x ? 'x' : 'y';
    this.plane.normal.set(axis === 'x' ? -1 : 0, axis === 'y' ? 1 : 0, 0);
    const place = bounds.getCenter(new THREE.Vector3())[axis] + 0.5 * this.cut * size[axis];
    this.plane.constant = axis === 'x' ? place : -place;
    this.renderer.clippingPlanes = [this.plane];
  }

  picture(): Promise<Blob> {
    return new Promise((done) => {
      this.keepPicture = (canvas) => canvas.toBlob((blob) => { if (blob) done(blob); }, 'image/png');
      this.touch();
    });
  }

  // Pixels of CSS that a millimetre takes at the middle of the view.
  pixelsPerMillimetre(): number {
    const distance = this.camera.position.distanceTo(this.orbit.target);
    return this.canvas.clientHeight / (2 * distance * Math.tan((this.camera.fov * Math.PI) / 360));
  }

  scaleBar(): { pixels: number; millimetres: number } {
    const per = this.pixelsPerMillimetre(), millimetres = roundLength(140 / per);
    return { pixels: per * millimetres, millimetres };
  }

  // The swatch under a point of the page, and the ray through it.
  private ray(x: number, y: number): { index: number; ray: THREE.Ray } {
    const box = this.canvas.getBoundingClientRect(), n = Math.max(1, this.swatches().length);
    const index = Math.min(n - 1, Math.max(0, Math.floor((x - box.left) / this.area(0).z)));
    const area = this.area(index);
    this.camera.aspect = area.z / area.w;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    const pointer = new THREE.Vector2(((x - box.left - area.x) / area.z) * 2 - 1, 1 - ((y - box.top) / area.w) * 2);
    const caster = new THREE.Raycaster();
    caster.setFromCamera(pointer, this.camera);
    return { index, ray: caster.ray };
  }

  // The yarn segment or pore under a point of the page: the nearest yarn that the ray passes within its radius; between
  // yarns, the pore it passes through.
  pick(x: number, y: number): Hit | null {
    const { index, ray } = this.ray(x, y);
    const swatch = this.swatches()[index];
    if (!swatch) return null;
    let best: Hit | null = null, nearest = Infinity;
    const a = new THREE.Vector3(), b = new THREE.Vector3(), onRay = new THREE.Vector3(), onYarn = new THREE.Vector3();
    swatch.yarns.forEach((yarns, textile) => {
      const info = yarns.info, p = yarns.points, per = info.steps_per_segment;
      for (let yarn = 0; yarn < info.yarn_radius.length; ++yarn) {
        const radius = 1000 * info.yarn_radius[yarn]!;
        for (let i = yarns.firstPoint[yarn]!; i + 1 < yarns.firstPoint[yarn + 1]!; ++i) {
          a.fromArray(p, 4 * i);
          b.fromArray(p, 4 * i + 4);
          if (this.cut !== null && this.plane.distanceToPoint(a) < 0) continue;
          const d2 = ray.distanceSqToSegment(a, b, onRay, onYarn);
          if (d2 > radius * radius) continue;
          const along = onRay.distanceTo(ray.origin) - Math.sqrt(radius * radius - d2);
          if (along >= nearest) continue;
          nearest = along;
          const segment = Math.min(Math.floor((i - yarns.firstPoint[yarn]!) / per), info.yarn_segments[yarn]! - 1);
          best = { swatch: index, textile, node: yarns.firstSegment[yarn]! + segment, place: ray.at(along, new THREE.Vector3()) };
        }
      }
      if (best) return;
      const pores = swatch.pores[textile]?.places() ?? [], reach = 500 * Math.min(...info.pitch);
      for (let i = 0; i < pores.length / 3; ++i) {
        a.fromArray(pores, 3 * i);
        if (this.cut !== null && this.plane.distanceToPoint(a) < 0) continue;
        const d2 = ray.distanceSqToPoint(a);
        if (d2 > reach * reach || Math.sqrt(d2) >= nearest) continue;
        nearest = Math.sqrt(d2);
        best = { swatch: index, textile, node: info.segments + i, place: a.clone() };
      }
    });
    const hit = this.hitCloth(swatch, ray);
    if (!hit || hit.distance > nearest) return best;
    const { a: i, b: j, c: k } = hit.face!, p = swatch.cloths[hit.cloth]!.points;
    const node = [i, j, k].sort((m, n) => a.fromArray(p, 3 * m).distanceTo(hit.point) - b.fromArray(p, 3 * n).distanceTo(hit.point))[0]!;
    return { swatch: index, textile: swatch.textiles.length + hit.cloth, node, place: hit.point };
  }

  // The nearest point of a soft sheet on a ray, on the side of the section that is seen.
  private hitCloth(swatch: Swatch, ray: THREE.Ray): (THREE.Intersection & { cloth: number }) | null {
    const caster = new THREE.Raycaster(ray.origin, ray.direction);
    let best: (THREE.Intersection & { cloth: number }) | null = null;
    swatch.cloths.forEach((cloth, i) => {
      const hit = caster.intersectObject(cloth.mesh, false).find((h) => this.cut === null || this.plane.distanceToPoint(h.point) >= 0);
      if (hit && (!best || hit.distance < best.distance)) best = { ...hit, cloth: i };
    });
    return best;
  }

  // Where the ray meets the face of a cloth (or the ground z = 0), in metres.
  placeOnCloth(x: number, y: number): { swatch: number; at: [number, number, number] } | null {
    const { index, ray } = this.ray(x, y);
    const swatch = this.swatches()[index];
    if (!swatch) return null;
    let best: THREE.Vector3 | null = null;
    for (const [i, info] of swatch.textiles.entries()) {
      if (swatch.yarns[i]?.moved) continue;
      const n = new THREE.Vector3(...info.n), u = new THREE.Vector3(...info.u), v = new THREE.Vector3(...info.v);
      const side = Math.sign(ray.origin.dot(n) - 1000 * new THREE.Vector3(...info.origin).dot(n)) || 1;
      const face = new THREE.Vector3(...info.origin).addScaledVector(n, side * 0.5 * info.thickness).multiplyScalar(1000);
      const hit = ray.intersectPlane(new THREE.Plane().setFromNormalAndCoplanarPoint(n, face), new THREE.Vector3());
      if (!hit) continue;
      const d = hit.clone().sub(face);
      if (Math.abs(d.dot(u)) > 500 * info.size[0] || Math.abs(d.dot(v)) > 500 * info.size[1]) continue;
      if (!best || hit.distanceTo(ray.origin) < best.distanceTo(ray.origin)) best = hit;
    }
    if (!best && swatch.yarns.some((yarns) => yarns.moved)) best = this.pick(x, y)?.place ?? null;
    const cloth = this.hitCloth(swatch, ray);
    if (cloth && (!best || cloth.distance < best.distanceTo(ray.origin))) best = cloth.point;
    if (!best && swatch.textiles.length + swatch.cloths.length === 0) best = ray.intersectPlane(new THREE.Plane(new THREE.Vector3(0, 0, 1), 0), new THREE.Vector3());
    return best ? { swatch: index, at: [best.x / 1000, best.y / 1000, best.z / 1000] } : null;
  }

  // Where a place (mm) is on the canvas, in CSS pixels.
  onScreen(place: THREE.Vector3, swatch: number): { x: number; y: number } {
    const area = this.area(swatch);
    this.camera.aspect = area.z / area.w;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    const p = place.clone().project(this.camera);
    return { x: area.x + (0.5 + 0.5 * p.x) * area.z, y: (0.5 - 0.5 * p.y) * area.w };
  }
}
