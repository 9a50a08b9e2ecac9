// The parameters, as the server describes them: no name, unit or range stands here. Folders are those of the scene file.
import GUI, { type Controller } from 'lil-gui';
import type { ControlRow } from './protocol';

export interface PanelHandlers { set(assignments: string[], restart: boolean): void }

const label = (path: string) => (path.split('.').pop() ?? path).replaceAll('_', ' ');

function linearToScreen(x: number): number { return x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055; }
function screenToLinear(x: number): number { return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4; }

interface Shown { row: ControlRow; value: { value: unknown }; controllers: Controller[]; axes: Record<string, number> | null }

export class Panel {
  private gui: GUI | null = null;
  private rows: ControlRow[] = [];
  private shown = new Map<string, Shown>();
  private signature = '';
  private readonly open = new Map<string, boolean>();
  private timer = 0;
  private readonly waiting = new Map<string, string>();
  filter = '';
  all = false;
  enabled = true;

  constructor(private readonly element: HTMLElement, private readonly handlers: PanelHandlers) {}

  update(rows: ControlRow[]): void {
    const round = (x: number) => Number(x.toPrecision(9));  // 30 deg, not the 29.999999999999996 that radians make of it
    this.rows = rows.map((row) => ({ ...row, ...(row.numbers && { numbers: row.numbers.map(round) }),
      ...(row.stands_for !== undefined && { stands_for: round(row.stands_for) }) }));
    rows = this.rows;
    const signature = this.visible().map((row) => `${row.path} ${row.choices?.length ?? 0}`).join('\n') + this.enabled;
    if (signature !== this.signature) { this.signature = signature; this.build(); }
    else this.refresh();
  }

  changed(): void { this.signature = ''; this.update(this.rows); }

  // For tests: the value that the page shows for a path.
  value(path: string): unknown { return this.shown.get(path)?.value.value; }

  private visible(): ControlRow[] {
    const words = this.filter.toLowerCase().split(/\s+/).filter(Boolean);
    return this.rows.filter((row) => row.kind !== 'group' && (this.all || words.length > 0 || row.effect === 'next step') &&
      words.every((word) => `${row.path} ${label(row.path)} ${row.help}`.toLowerCase().includes(word)));
  }

  // What one changes most comes first: the cloth, and in each folder its own values before the folders in it.
  private ordered(): ControlRow[] {
    const groups = ['textiles', 'liquid', 'air', 'gravity', 'solids', 'duration'];
    const rank = (row: ControlRow) => (groups.indexOf(row.path.replace(/[.[].*/, '')) + groups.length + 1) % (groups.length + 1);
    return this.visible().sort((a, b) => rank(a) - rank(b) || a.path.split('.').length - b.path.split('.').length);
  }

  private build(): void {
    const scroll = this.element.scrollTop;
    this.gui?.destroy();
    this.shown.clear();
    const gui = new GUI({ container: this.element, title: 'Scene', width: 0 });
    gui.domElement.style.width = '';
    this.gui = gui;
    const folders = new Map<string, GUI>([['', gui]]);
    const help = new Map(this.rows.map((row) => [row.path, row.help]));
    const folder = (path: string): GUI => {
      const known = folders.get(path);
      if (known) return known;
      const dot = path.lastIndexOf('.');
      const name = /\[\d+\]$/.test(path) ? this.rows.find((row) => row.path === `${path}.name`)?.text?.replaceAll('"', '') : '';
      const made = folder(dot < 0 ? '' : path.slice(0, dot)).addFolder(label(path).replace(/s?\[(\d+)\]$/, (_, i) => ` ${Number(i) + 1}`) + (name ? `: ${name}` : ''));
      made.$title.title = help.get(path) ?? '';
      const depth = path.split('.').length;
      const open = this.open.get(path) ?? (this.filter !== '' || (depth === 1 && !/solver|measures|domain|solids/.test(path)) || /^liquid\.kind$|^liquid\.pipes\[\d+\]$|\.wetting$|\.wetting\.cells$/.test(path));
      if (!open) made.close();
      made.onOpenClose((g: GUI) => { if (g === made) this.open.set(path, !made._closed); });
      folders.set(path, made);
      return made;
    };
    for (const row of this.ordered()) {
      const dot = row.path.lastIndexOf('.');
      this.add(folder(dot < 0 ? '' : row.path.slice(0, dot)), row);
    }
    this.element.scrollTop = scroll;
  }

  private add(gui: GUI, row: ControlRow): void {
    const shown: Shown = { row, value: { value: this.read(row) }, controllers: [], axes: null };
    const mark = row.effect === 'restart' ? ' ⟲' : '';
    const name = `${label(row.path)}${row.unit ? ` (${row.unit})` : ''}${mark}`;
    const controllers = this.controllers(gui, row, shown, name);
    for (const controller of controllers) {
      controller.domElement.title = this.explain(row);
      controller.domElement.dataset['path'] = row.path;
      if (!this.enabled) controller.disable();
    }
    shown.controllers = controllers;
    this.shown.set(row.path, shown);
  }

  private controllers(gui: GUI, row: ControlRow, shown: Shown, name: string): Controller[] {
    const send = (value: unknown) => this.send(row, value);
    if (row.kind === 'choice' || row.choices) return [gui.add(shown.value, 'value', row.choices ?? []).name(name).onChange(send)];
    if (row.kind === 'boolean') return [gui.add(shown.value, 'value').name(name).onChange(send)];
    if (row.kind === 'text' || (row.length !== 1 && row.length !== 2 && row.length !== 3)) return [gui.add(shown.value, 'value').name(name).onFinishChange(send)];
    if (row.length === 3 && row.path.endsWith('.colour')) {
      shown.value.value = (row.numbers ?? [0.5, 0.5, 0.5]).map(linearToScreen);
      return [gui.addColor(shown.value as { value: number[] }, 'value').name(name)
        .onFinishChange((c: number[]) => send(c.map((x) => Number(screenToLinear(x).toFixed(4)))))];
    }
    if (row.length !== 1) {
      const axes: Record<string, number> = {};
      const names = ['x', 'y', 'z'].slice(0, row.length);
      names.forEach((axis, i) => { axes[axis] = row.numbers?.[i] ?? 0; });
      shown.axes = axes;
      const part = gui.addFolder(name);
      part.close();
      return names.map((axis) => part.add(axes, axis).decimals(4).onFinishChange(() => send(names.map((a) => axes[a]))));
    }
    const value = row.numbers?.[0] ?? row.stands_for ?? Math.max(row.low ?? 0, 0);
    shown.value.value = value;
    const range = this.range(row, value);
    const controller = range ? gui.add(shown.value as { value: number }, 'value', range[0], range[1]) : gui.add(shown.value as { value: number }, 'value');
    if (row.kind === 'integer') controller.step(1);
    else if (range) controller.step(10 ** Math.floor(Math.log10(range[1] - range[0]) - 2));
    if (row.numbers === undefined) controller.domElement.classList.add('not-given');
    controller.name(name);
    return [row.effect === 'restart' ? controller.onFinishChange(send) : controller.onChange(send)];
  }

  // What the slider spans: the whole range where that is handy, else a few times the value around it.
  private range(row: ControlRow, value: number): [number, number] | null {
    const low = row.low ?? -Infinity, high = row.high ?? Infinity;
    if (Number.isFinite(low) && Number.isFinite(high) && high - low <= 200 && (value === 0 || high <= 40 * Math.abs(value) || high - low <= 200 && Math.abs(value) >= 1)) return [low, high];
    if (row.kind === 'integer' || value === 0) return null;
    return value > 0 ? [Math.max(low, value / 10), Math.min(high, 5 * value)] : [Math.max(low, 5 * value), Math.min(high, value / 10)];
  }

  private explain(row: ControlRow): string {
    const unit = row.unit ? ` ${row.unit}` : '';
    const range = row.low !== undefined && row.high !== undefined ? `\n${row.above_low ? 'above' : 'from'} ${row.low} to ${row.high}${unit}` : '';
    const effect = row.effect === 'next step' ? 'takes effect at the next step' : 'cannot change while the cloth gets wet: changing it begins anew';
    return `${row.help}${range}\n${row.path}\n${effect}${row.numbers === undefined && row.stands_for !== undefined ? "\nnot given: the material's own" : ''}`;
  }

  private read(row: ControlRow): unknown {
    if (row.kind === 'boolean') return row.text === 'true';
    return (row.text ?? '').replace(/^"(.*)"$/, '$1');
  }

  private written(row: ControlRow, value: unknown): string {
    const one = (x: unknown) => (typeof x === 'number' ? `${Number(x.toPrecision(7))}${row.unit ? ` ${row.unit}` : ''}` : row.kind === 'text' ? JSON.stringify(x) : String(x));
    return Array.isArray(value) ? `[${value.map(one).join(', ')}]` : one(value);
  }

  // A slider tells many values: the first at once, then at most one message in 50 ms, the last one always.
  private send(row: ControlRow, value: unknown): void {
    if (row.effect === 'restart') return this.handlers.set([`${row.path}=${this.written(row, value)}`], true);
    this.waiting.set(row.path, this.written(row, value));
    if (this.timer) return;
    const sendWaiting = () => {
      this.timer = 0;
      if (this.waiting.size === 0) return;
      const assignments = [...this.waiting].map(([path, text]) => `${path}=${text}`);
      this.waiting.clear();
      this.handlers.set(assignments, false);
      this.timer = window.setTimeout(sendWaiting, 50);
    };
    sendWaiting();
  }

  private refresh(): void {
    const rows = new Map(this.rows.map((row) => [row.path, row]));
    for (const shown of this.shown.values()) {
      const row = rows.get(shown.row.path);
      if (!row || this.waiting.has(row.path)) continue;
      shown.row = row;
      if (shown.axes) ['x', 'y', 'z'].forEach((axis, i) => { if (shown.axes && axis in shown.axes) shown.axes[axis] = row.numbers?.[i] ?? 0; });
      else if (row.length === 3 && row.path.endsWith('.colour')) shown.value.value = (row.numbers ?? [0.5, 0.5, 0.5]).map(linearToScreen);
      else if (row.kind === 'number' || row.kind === 'integer') shown.value.value = row.numbers?.[0] ?? row.stands_for ?? shown.value.value;
      else shown.value.value = this.read(row);
      for (const controller of shown.controllers) {
        if (row.numbers !== undefined) controller.domElement.classList.remove('not-given');
        if (!controller.domElement.contains(document.activeElement)) controller.updateDisplay();
      }
    }
  }

  // A change that the server has taken: shown for a moment.
  taken(assignments: string[]): void {
    for (const assignment of assignments) {
      const shown = this.shown.get(assignment.slice(0, assignment.indexOf('=')));
      for (const controller of shown?.controllers ?? []) {
        controller.domElement.classList.remove('taken');
        void controller.domElement.offsetWidth;  // so that the animation begins anew
        controller.domElement.classList.add('taken');
      }
    }
  }
}
