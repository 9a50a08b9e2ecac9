import './style.css';
import { Connection } from './connection';
import { Curves } from './curves';
import { byId, download } from './dom';
import { compareDialog, galleryDialog, helpDialog } from './dialogs';
import { drawLegend } from './legend';
import { showPick } from './pick';
import { Panel } from './panel';
import { Flag, type ClientMessage, type ControlRow, type Frame, type HelloMessage, type InspectMessage, type Problem, type ServerMessage } from './protocol';
import { Swatch } from './swatch';
import { duration, withPrefix } from './text';
import { View, type Hit, type Quality } from './view';
import * as THREE from 'three';

const parameters = new URLSearchParams(location.search);
const look = {
  natural: { value: 0 },
  bar: { value: Array.from({ length: 11 }, () => new THREE.Vector4(1, 1, 1, 1)) },
  levels: { value: 11 },
  scale: { value: 200 },
  pixels: { value: 600 },
};
let hello: HelloMessage | null = null;
let swatches: Swatch[] = [];
let wanted = 1;               // swatches that the server has
let holder = 0;
let target = 0;               // swatch that the parameters change
let picked: Hit | null = null;
let mode: 'look' | 'drop' = 'look';
let fitted = '';
let toFit: 'free' | 'keep' | null = null;  // once the first frame tells where the liquid hangs
const rows: ControlRow[][] = [[], []];
const counters = { frames: 0, bytes: 0, errors: 0, notices: 0, changes: 0, connects: 0, geometries: 0, largest: 0, problems: [] as Problem[], lastChange: null as null | { set: string[]; step: number; time: number } };

const view = new View(byId<HTMLCanvasElement>('canvas'), () => swatches, afterDraw);
const curves = new Curves([byId('chart-mass'), byId('chart-area'), byId('chart-front')], () => swatches);
const connection = new Connection({ message: onMessage, frame: onFrame, state: onState });
const panel = new Panel(byId('controls'), {
  set: (assign, restart) => connection.send({ type: 'set', swatch: target, assign, restart }),
});
const sides = () => (view.quality === 'fine' ? 12 : 6);
const all = () => (swatches.length > 1 ? 255 : 0);
const running = () => ((swatches[0]?.flags ?? 0) & Flag.running) !== 0;

function onState(connected: boolean): void {
  document.body.classList.toggle('away', !connected);
  if (connected) ++counters.connects;
  else toast('The server is away; trying again …', 'warning', 'away');
}

function onMessage(message: ServerMessage): void {
  switch (message.type) {
    case 'hello': return onHello(message);
    case 'scene': {
      const swatch = swatchAt(message.swatch);
      swatch.begin(message);
      rows[message.swatch] = message.controls;
      showTitle();
      byId('seek').hidden = !message.replay;
      document.body.classList.toggle('replay', message.replay);
      showPanel();
      forgetPick();
      return;
    }
    case 'controls':
      holder = message.holder;
      byId('viewers').innerHTML = '';
      byId('viewers').append(holder === hello?.viewer ? 'You hold the controls' : 'Another viewer holds the controls',
        message.viewers > 1 ? ` · ${message.viewers} viewers` : '');
      if (holder !== hello?.viewer) byId('viewers').append(button('Take them', () => connection.send({ type: 'take' })));
      document.body.classList.toggle('watching', holder !== hello?.viewer);
      panel.enabled = holder === hello?.viewer;
      panel.changed();
      return;
    case 'changed': {
      rows[message.swatch] = message.controls;
      const swatch = swatches[message.swatch];
      if (swatch?.message) swatch.message.duration = message.duration;
      if (message.set.length > 0) {
        ++counters.changes;
        counters.lastChange = { set: message.set, step: message.step, time: message.time };
        const what = message.set.map((s) => (s.startsWith('liquid.drops[') ? 'drop' : s)).join(', ');
        toast(`${what} · taken at step ${message.step}, ${duration(message.time)}`, 'taken', 'taken');
      }
      showPanel();
      if (message.swatch === shownSwatch()) panel.taken(message.set);
      return;
    }
    case 'error':
      ++counters.errors;
      counters.problems = message.problems;
      return toast(message.problems.map(problemText).join('\n'), 'error', message.about);
    case 'notice':
      ++counters.notices;
      return toast(message.message, 'notice', message.message);
    case 'speed': byId<HTMLSelectElement>('speed').value = String(message.limit); return;
    case 'swatches': return setSwatches(message.count);
    case 'inspect': return onInspect(message);
    case 'history': {
      const swatch = swatches[message.swatch];
      if (swatch?.generation === message.generation) swatch.series.load(message.rows), curves.rebuild();
      return;
    }
    case 'done': return answered(message);
    case 'scene_text': return download('scene.yaml', new Blob([message.text], { type: 'text/yaml' }));
  }
}

// Messages that ask to be told when they were carried out: by every swatch that they are for.
type Done = Extract<ServerMessage, { type: 'done' }>;
const asked = new Map<number, { missing: number; resolve: (done: Done) => void }>();
let asks = 0;
function ask(message: ClientMessage & { swatch?: number }): Promise<Done> {
  const number = ++asks;
  return new Promise((resolve) => {
    asked.set(number, { missing: message.swatch === 255 ? wanted : 1, resolve });
    connection.send({ ...message, ask: number });
  });
}
function answered(done: Done): void {
  const waiting = asked.get(done.ask);
  if (!waiting || --waiting.missing > 0) return;
  asked.delete(done.ask);
  waiting.resolve(done);
}

function onHello(message: HelloMessage): void {
  const again = hello !== null && hello.version !== message.version;
  if (again) location.reload();
  hello = message;
  for (const swatch of swatches) swatch.dispose();
  swatches = [];
  wanted = message.swatches;
  setSwatches(wanted);
  look.scale.value = message.saturation_scale;
  message.bar.forEach((c, i) => look.bar.value[i]?.set(...c));
  drawLegend(message.bar);
  byId<HTMLSelectElement>('speed').value = String(message.speed_limit);
  byId('gallery-button').hidden = message.gallery.length === 0;
  byId('toasts').querySelector('[data-about=away]')?.remove();
}

function swatchAt(index: number): Swatch {
  while (swatches.length <= index) swatches.push(new Swatch(hello!, look));
  return swatches[index]!;
}

function setSwatches(count: number): void {
  wanted = count;
  while (swatches.length > count) swatches.pop()?.dispose();
  byId('swatch').hidden = count < 2;
  byId('compare').classList.toggle('on', count > 1);
  if (count < 2) target = 0, byId<HTMLSelectElement>('swatch').value = '0';
  showTitle();
  curves.rebuild();
  view.fit('keep');
}

// Two views leave the colour bar its own room, and their labels keep to them.
function layOut(): void {
  view.margin = byId('legend').hidden ? 0 : byId('legend').offsetWidth + 20;
  byId('labels').style.right = `${swatches.length > 1 ? view.margin : 0}px`;
  view.touch();
}

function onFrame(frame: Frame): void {
  const swatch = swatchAt(frame.swatch);
  swatch.take(frame, sides());
  if (frame.geometry) {
    ++counters.geometries;
    view.setQuality(view.quality);
    const key = swatches.map((s) => `${s.message?.title} ${s.bounds.min.toArray()} ${s.bounds.max.toArray()}`).join();
    if (key !== fitted) { fitted = key; view.fit(toFit = counters.geometries <= wanted ? 'free' : 'keep'); }
    curves.rebuild();
  } else {
    if (toFit && swatches.every((s) => s.frames > 0)) { view.fit(toFit); toFit = null; }
    ++counters.frames;
    counters.bytes += frame.bytes;
    counters.largest = Math.max(counters.largest, frame.bytes);
    curves.update();
    showStatus();
  }
  view.touch();
}

// ---- what is always seen

function showTitle(): void {
  const titles = swatches.map((s) => s.message?.title ?? '');
  byId('title').textContent = titles[0] || 'Imbibe';
  document.title = `${titles[0] || 'Imbibe'} · Imbibe live`;
  byId('labels').innerHTML = '';
  layOut();
  if (swatches.length > 1)
    swatches.forEach((s, i) => {
      const t = s.textiles[0], label = document.createElement('div');
      const row = (end: string) => rows[i]?.find((r) => r.path === `textiles[0].${end}`)?.text?.replaceAll('"', '') ?? '';
      label.textContent = t ? `${i === 0 ? 'left' : 'right'}: ${[row('weave'), `${row('warp.fibre')} × ${row('weft.fibre')}`, row('contact_angle')].filter(Boolean).join(', ')}`
        : `${i === 0 ? 'left' : 'right'}: ${[row('sheet.soft.preset'), row('contact_angle'), row('wetting.cells.absorption_factor')].filter(Boolean).join(', ')}`;
      byId('labels').append(label);
    });
}

function showStatus(): void {
  const s = swatches[0];
  if (!s || !hello) return;
  const flags = s.flags, time = s.value('time_s');
  byId('time').textContent = duration(time);
  const speed = s.value('speed');
  byId('pace').textContent = (flags & Flag.failed) ? 'failed' : (flags & Flag.ended) ? 'at the end' : (flags & Flag.running)
    ? (speed > 0 ? `${Number(speed.toPrecision(2))}× real time` : 'running') : 'paused';
  const run = byId('run');
  run.textContent = running() ? 'Pause' : (flags & Flag.ended) && !(flags & Flag.replay) ? 'Go on' : 'Run';
  byId('record').classList.toggle('on', (flags & Flag.recording) !== 0);
  const chips: [string, string, string][] = [];
  swatches.forEach((swatch, i) => {
    const side = swatches.length > 1 ? (i === 0 ? 'left ' : 'right ') : '';
    const step = swatch.value('step_s'), ledger = swatch.value('ledger_error');
    const bound = hello!.step_bounds[swatch.value('step_bound')] ?? '';
    chips.push(['', `${side}step ${withPrefix(step, 's')}${bound ? ` (${bound})` : ''}`, 'Size of the last step, and what held it']);
    chips.push([ledger > 1e-9 ? 'warning' : '', `${side}ledger error ${ledger === 0 ? '0' : ledger.toExponential(1)}`, 'Mass that is missing, of all there is']);
    const particles = swatch.value('particles');
    chips.push(['', `${side}${particles.toLocaleString('en')} particles${(swatch.flags & Flag.resting) ? ', at rest' : ''}`, 'Of free liquid']);
    if (swatch.value('left_kg') > 0) chips.push(['warning', `${side}${withPrefix(1e3 * swatch.value('left_kg'), 'g')} left the domain`, 'Liquid that fell out of the scene']);
    if (swatch.value('converged') === 0 && step > 0 && !(flags & Flag.replay)) chips.push(['warning', `${side}solver at its bound`, 'The last step used all its iterations']);
    if (swatch.value('peak_density_error') > 0.2) chips.push(['warning', `${side}compressed ${(100 * swatch.value('peak_density_error')).toFixed(0)} %`, 'Largest compression of a particle']);
  });
  const html = chips.map(([kind, text, help]) => `<span class="${kind}" title="${help}">${text}</span>`).join('');
  const status = byId('status');
  if (status.innerHTML !== html) status.innerHTML = html;
  if (flags & Flag.replay) {
    const bar = byId('seek').querySelector('input')!;
    bar.max = String(s.message?.duration ?? 1);
    if (document.activeElement !== bar || !bar.matches(':active')) bar.value = String(time);
  }
}

function afterDraw(): void {
  look.pixels.value = view.canvas.height;
  const { pixels, millimetres } = view.scaleBar();
  byId('scale').style.setProperty('--width', `${pixels}px`);
  byId('scale').querySelector('span')!.textContent = withPrefix(millimetres / 1000, 'm', 1);
}

function shownSwatch(): number { return target === 255 ? 0 : target; }
function showPanel(): void { panel.update(rows[shownSwatch()] ?? []); showTitle(); }

function problemText(p: Problem): string {
  const place = p.line > 0 ? `${p.file.split('/').pop()}:${p.line}:${p.column}: ` : '';
  return `${place}${p.key ? `${p.key}: ` : ''}${p.message}`;
}

function toast(text: string, kind: 'error' | 'notice' | 'warning' | 'taken', about: string): void {
  const box = byId('toasts');
  box.querySelector(`[data-about="${CSS.escape(about)}"]`)?.remove();
  const item = document.createElement('div');
  item.className = kind;
  item.dataset['about'] = about;
  item.textContent = text;
  item.title = 'Click to remove';
  item.onclick = () => item.remove();
  box.append(item);
  while (box.childElementCount > 4) box.firstElementChild?.remove();
  if (kind !== 'error' && about !== 'away') setTimeout(() => item.remove(), kind === 'taken' ? 3500 : 6000);
  if (kind === 'error') setTimeout(() => item.remove(), 20000);
}

function button(text: string, action: () => void): HTMLButtonElement {
  const made = document.createElement('button');
  made.textContent = text;
  made.onclick = action;
  return made;
}

// ---- picking and dropping

let pickTimer = 0;
function pick(hit: Hit | null): void {
  picked = hit;
  window.clearInterval(pickTimer);
  if (!hit) return forgetPick();
  const ask = () => connection.send({ type: 'inspect', swatch: hit.swatch, textile: hit.textile, node: hit.node });
  ask();
  pickTimer = window.setInterval(() => { if (running()) ask(); }, 400);
}
function forgetPick(): void { picked = null; window.clearInterval(pickTimer); byId('pick').hidden = true; }
const looks: ((place: InspectMessage['place']) => void)[] = [];  // of tests
function onInspect(message: InspectMessage): void { looks.shift()?.(message.place); if (picked) showPick(byId('pick'), message, forgetPick); }

function setMode(next: 'look' | 'drop'): void {
  mode = next;
  byId('mode-look').classList.toggle('on', mode === 'look');
  byId('mode-drop').classList.toggle('on', mode === 'drop');
  byId('drop-volume-field').hidden = mode !== 'drop';
  view.canvas.style.cursor = mode === 'drop' ? 'crosshair' : '';
}

let pressed: { x: number; y: number } | null = null;
view.canvas.addEventListener('pointerdown', (e) => { pressed = { x: e.clientX, y: e.clientY }; });
view.canvas.addEventListener('pointerup', (e) => {
  if (!pressed || e.button !== 0 || Math.hypot(e.clientX - pressed.x, e.clientY - pressed.y) > 4) return;
  if (mode === 'look') return pick(view.pick(e.clientX, e.clientY));
  const place = view.placeOnCloth(e.clientX, e.clientY);
  if (!place) return toast('Click on the cloth to let a drop fall there', 'notice', 'drop');
  const volume = Number(byId<HTMLInputElement>('drop-volume').value) * 1e-9;
  connection.send({ type: 'drop', swatch: all(), at: place.at, volume, speed: 0.1 });
});

// ---- buttons and keys

const actions: Record<string, () => void> = {
  run: () => {
    if (running()) return connection.send({ type: 'pause', swatch: all() });
    const s = swatches[0];
    if (s && s.flags & Flag.ended && !(s.flags & Flag.replay))  // as long again
      connection.send({ type: 'set', swatch: all(), assign: [`duration=${2 * s.value('time_s')} s`] });
    connection.send({ type: 'run', swatch: all() });
  },
  step: () => connection.send({ type: 'step', swatch: all(), steps: 1 }),
  reset: () => connection.send({ type: 'reset', swatch: all() }),
  record: () => connection.send({ type: 'record', swatch: all(), on: !byId('record').classList.contains('on') }),
  snapshot: () => { void view.picture().then((blob) => download(`imbibe_${swatches[0]?.value('time_s').toFixed(3)}s.png`, blob)); },
  save: () => connection.send({ type: 'save', swatch: shownSwatch() }),
  compare: () => {
    if (swatches.length > 1) return connection.send({ type: 'compare', on: false });
    compareDialog(rows[0] ?? [], (assign) => connection.send({ type: 'compare', on: true, assign }));
  },
  theme: () => setTheme(document.documentElement.dataset['theme'] === 'dark' ? 'light' : 'dark'),
  help: () => helpDialog(),
  'gallery-button': () => galleryDialog(hello?.gallery ?? [], (id) => connection.send({ type: 'open', swatch: 0, gallery: id }), openFile),
  'panel-button': () => document.body.classList.toggle('panel-open'),
  'mode-look': () => setMode('look'),
  'mode-drop': () => setMode('drop'),
  fit: () => view.fit('free'),
  top: () => view.fit('top'),
  side: () => view.fit('side'),
  section: () => {
    const on = byId('section').classList.toggle('on'), place = byId<HTMLInputElement>('section-place');
    place.hidden = !on;
    view.setSection(on ? Number(place.value) : null);
  },
  csv: () => swatches.forEach((s, i) => download(swatches.length > 1 ? `curves_${i === 0 ? 'left' : 'right'}.csv` : 'curves.csv', new Blob([s.series.csv()], { type: 'text/csv' }))),
};
for (const [id, action] of Object.entries(actions)) byId(id).addEventListener('click', action);

const keys: Record<string, string> = { ' ': 'run', '.': 'step', r: 'reset', p: 'snapshot', c: 'compare', l: 'theme', '?': 'help', g: 'gallery-button',
  i: 'mode-look', d: 'mode-drop', f: 'fit', t: 'top', s: 'side', x: 'section' };
document.addEventListener('keydown', (e) => {
  const at = e.target as HTMLElement;
  if (e.key === 'Escape' && at.tagName === 'INPUT' && !at.closest('dialog')) return at.blur();  // back to the keys of the view
  if (e.ctrlKey || e.metaKey || e.altKey || /^(INPUT|SELECT|TEXTAREA)$/.test(at.tagName) || at.closest('dialog')) return;
  if (at.tagName === 'BUTTON' && (e.key === ' ' || e.key === 'Enter')) return;
  const turns: Record<string, () => void> = { ArrowLeft: () => view.turn(-0.12, 0), ArrowRight: () => view.turn(0.12, 0),
    ArrowUp: () => view.turn(0, -0.1), ArrowDown: () => view.turn(0, 0.1), '+': () => view.zoom(0.85), '-': () => view.zoom(1 / 0.85),
    Escape: () => { forgetPick(); byId('toasts').innerHTML = ''; } };
  const action = turns[e.key] ?? actions[keys[e.key.toLowerCase()] ?? ''];
  if (!action) return;
  e.preventDefault();
  action();
});

byId<HTMLSelectElement>('speed').onchange = (e) => connection.send({ type: 'speed', swatch: all(), limit: Number((e.target as HTMLSelectElement).value) });
byId<HTMLSelectElement>('look').onchange = (e) => {
  look.natural.value = (e.target as HTMLSelectElement).value === 'natural' ? 1 : 0;
  byId('legend').hidden = look.natural.value === 1;
  layOut();
};
byId<HTMLSelectElement>('quality').onchange = (e) => view.setQuality((e.target as HTMLSelectElement).value as Quality);
byId<HTMLInputElement>('section-place').oninput = (e) => view.setSection(Number((e.target as HTMLInputElement).value));
byId<HTMLInputElement>('filter').oninput = (e) => { panel.filter = (e.target as HTMLInputElement).value; panel.changed(); };
byId<HTMLInputElement>('show-all').onchange = (e) => { panel.all = (e.target as HTMLInputElement).checked; panel.changed(); };
byId<HTMLSelectElement>('swatch').onchange = (e) => { target = Number((e.target as HTMLSelectElement).value); showPanel(); };
byId<HTMLInputElement>('drop-volume').onkeydown = (e) => { if (e.key === 'Enter' || e.key === 'Escape') (e.target as HTMLElement).blur(); };
byId('seek').querySelector('input')!.oninput = (e) => connection.send({ type: 'seek', time: Number((e.target as HTMLInputElement).value) });

// ---- files dropped on the page

async function openFile(file: File): Promise<void> {
  if (file.size > 1 << 20) return toast(`${file.name}: larger than 1 MB`, 'error', 'open');
  connection.send({ type: 'open', swatch: 0, name: file.name, text: await file.text() });
}
document.addEventListener('dragover', (e) => { e.preventDefault(); byId('drop-here').hidden = false; });
document.addEventListener('dragleave', (e) => { if (!e.relatedTarget) byId('drop-here').hidden = true; });
document.addEventListener('drop', (e) => {
  e.preventDefault();
  byId('drop-here').hidden = true;
  const file = e.dataTransfer?.files[0];
  if (file) void openFile(file);
});

// ---- look of the page

function setTheme(theme: string): void {
  document.documentElement.dataset['theme'] = theme;
  try { localStorage.setItem('imbibe-theme', theme); } catch { /* a page without storage forgets it */ }
  view.setDark(theme === 'dark');
  curves.rebuild();
}
let theme = parameters.get('theme') ?? '';
try { theme ||= localStorage.getItem('imbibe-theme') ?? ''; } catch { /* as above */ }
setTheme(theme || (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light'));
const quality: Quality = parameters.get('quality') === 'plain' || (parameters.get('quality') !== 'fine' && view.software) ? 'plain' : 'fine';
byId<HTMLSelectElement>('quality').value = quality;
view.setQuality(quality);

// What tests wait for and look at.
Object.assign(window, {
  imbibe: {
    counters, view, panel, curves,
    get swatches() { return swatches; },
    get hello() { return hello; },
    get holder() { return holder; },
    send: (message: { type: string }) => connection.send(message),
    ask,
    inspect: (textile: number, node: number) => new Promise((resolve) => { looks.push(resolve); connection.send({ type: 'inspect', swatch: 0, textile, node }); }),
    sendRaw: (text: string) => connection.sendRaw(text),
    openText: (name: string, text: string) => connection.send({ type: 'open', swatch: 0, name, text }),
    screen: (place: [number, number, number], swatch = 0) => view.onScreen(new THREE.Vector3(...place).multiplyScalar(1000), swatch),
  },
});
