// The live curves: where the liquid is, the wetted area, and the front against the root of time (Lucas-Washburn is a
// straight line there). Of two swatches the second is dashed.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import type { Swatch } from './swatch';

interface Curve { column: string; name: string; colour: string; minus?: string; of?: 'yarns' | 'cells' }
interface Chart { title: string; x: 'time' | 'root'; factor: number; curves: Curve[]; plot: uPlot | null; element: HTMLElement; signature: string }

// Okabe and Ito's colours, which the colour-blind can tell apart; blue is left to the liquid in the yarns.
const ORANGE = '#e69f00', SKY = '#56b4e9', GREEN = '#009e73', BLUE = '#0072b2', RED = '#d55e00', PINK = '#cc79a7';

export class Curves {
  private readonly charts: Chart[];
  private last = 0;
  private later = 0;

  constructor(elements: HTMLElement[], private readonly swatches: () => Swatch[]) {
    const chart = (i: number, title: string, x: 'time' | 'root', factor: number, curves: Curve[]): Chart =>
      ({ title, x, factor, curves, plot: null, element: elements[i]!, signature: '' });
    this.charts = [
      chart(0, 'Liquid (mg)', 'time', 1e6, [
        { column: 'free_kg', name: 'free', colour: SKY }, { column: 'yarn_kg', name: 'in yarns', colour: BLUE, of: 'yarns' },
        { column: 'pore_kg', name: 'in pores', colour: GREEN, of: 'yarns' }, { column: 'cell_kg', name: 'in the cloth', colour: BLUE, of: 'cells' },
        { column: 'sorbed_kg', name: 'sorbed', colour: ORANGE, minus: 'initial_kg', of: 'yarns' }, { column: 'evaporated_kg', name: 'evaporated', colour: PINK }]),
      chart(1, 'Wetted area (mm²)', 'time', 1e6, [
        { column: 'wet_area_m2', name: 'yarns', colour: BLUE, of: 'yarns' }, { column: 'wet_pore_area_m2', name: 'pores', colour: GREEN, of: 'yarns' },
        { column: 'wet_area_m2', name: 'cloth', colour: BLUE, of: 'cells' }]),
      chart(2, 'Front (mm) over √t', 'root', 1e3, [
        { column: 'wet_extent_warp_m', name: 'along warp', colour: BLUE }, { column: 'wet_extent_weft_m', name: 'along weft', colour: RED },
        { column: 'wet_height_m', name: 'height', colour: GREEN }]),
    ];
    new ResizeObserver(() => this.update(true)).observe(elements[0]!);
  }

  rebuild(): void { for (const chart of this.charts) chart.signature = ''; this.update(true); }

  // At most five times a second.
  update(now = false): void {
    window.clearTimeout(this.later);
    if (!now && performance.now() - this.last < 200) {  // the last rows are drawn in any case
      this.later = window.setTimeout(() => this.update(true), 250);
      return;
    }
    this.last = performance.now();
    for (const chart of this.charts) this.draw(chart);
  }

  // Those of what the scene has: yarns with pores, or cloth of cells (or neither: then of yarns).
  private curvesOf(chart: Chart): Curve[] {
    const all = this.swatches(), cells = all.some((s) => s.message?.cloths.length), yarns = !cells || all.some((s) => s.textiles.length);
    return chart.curves.filter((c) => !c.of || (c.of === 'cells' ? cells : yarns));
  }

  private draw(chart: Chart): void {
    const swatches = this.swatches();
    if (swatches.length === 0 || chart.element.clientWidth === 0) return;
    const width = chart.element.clientWidth, height = chart.element.clientHeight - 16;  // under the title
    const curves = this.curvesOf(chart);
    const signature = `${swatches.length} ${curves.length} ${getComputedStyle(document.documentElement).getPropertyValue('--ink')}`;
    if (signature !== chart.signature || !chart.plot) {
      chart.plot?.destroy();
      chart.plot = new uPlot(this.options(chart, swatches.length, width, height), [[]], chart.element);
      chart.signature = signature;
    }
    // A title with the names of many curves takes a third line on a narrow page.
    const title = chart.plot.root.querySelector<HTMLElement>('.u-title'), wrap = chart.plot.root.querySelector<HTMLElement>('.u-wrap')!;
    const more = Math.max(0, (title?.offsetHeight ?? 0) - 34);
    wrap.style.top = `${16 + more}px`;
    if (chart.plot.width !== width || chart.plot.height !== height - more) chart.plot.setSize({ width, height: height - more });
    const tables = swatches.map((swatch) => {
      const x = swatch.series.column('time_s').map((t) => (chart.x === 'root' ? Math.sqrt(Math.max(t, 0)) : t));
      const ys = curves.map((curve) => {
        const y = swatch.series.column(curve.column, chart.factor);
        const minus = curve.minus ? swatch.series.column(curve.minus, chart.factor) : null;
        return minus ? y.map((v, i) => v - minus[i]!) : y;
      });
      return [x, ...ys] as uPlot.AlignedData;
    });
    chart.plot.setData(tables.length > 1 ? uPlot.join(tables) : tables[0]!);
  }

  private options(chart: Chart, swatches: number, width: number, height: number): uPlot.Options {
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue('--ink').trim(), faint = style.getPropertyValue('--line').trim();
    const axis = { stroke: ink, grid: { stroke: faint, width: 1 }, ticks: { stroke: faint, width: 1, size: 4 }, font: '11px system-ui, sans-serif', gap: 3 };
    const series: uPlot.Series[] = [{ label: chart.x === 'root' ? '√s' : 's' }];
    for (let i = 0; i < swatches; ++i)
      for (const curve of this.curvesOf(chart))
        series.push({ label: swatches > 1 ? `${curve.name} ${i === 0 ? 'left' : 'right'}` : curve.name, stroke: curve.colour, width: 1.8,
          dash: i === 1 ? [6, 4] : [], spanGaps: true, points: { show: false } });
    return {
      width, height, title: chart.title, series, pxAlign: false,
      legend: { show: false }, cursor: { drag: { x: false, y: false }, points: { size: 5 } },
      scales: { x: { time: false } },
      axes: [{ ...axis, size: 26, label: chart.x === 'root' ? '√t (√s)' : 't (s)', labelSize: 14, labelFont: '11px system-ui, sans-serif' }, { ...axis, size: 44 }],
      hooks: { ready: [(plot) => this.key(chart, plot)], draw: [(plot) => this.now(chart, plot, ink)] },
    };
  }

  // Where a replay is on its curves, which are those of the whole run.
  private now(chart: Chart, plot: uPlot, ink: string): void {
    const swatch = this.swatches()[0];
    if (!swatch?.series.whole) return;
    const t = Math.max(0, swatch.value('time_s')), x = Math.round(plot.valToPos(chart.x === 'root' ? Math.sqrt(t) : t, 'x', true));
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.globalAlpha = 0.45;
    ctx.fillStyle = ink;
    ctx.fillRect(x, bbox.top, Math.max(1, Math.round(devicePixelRatio)), bbox.height);
    ctx.restore();
  }

  // The names of the curves beside the title, where they take no room from the curves.
  private key(chart: Chart, plot: uPlot): void {
    const title = plot.root.querySelector('.u-title');
    if (!title) return;
    const key = document.createElement('span');
    key.className = 'key';
    for (const curve of this.curvesOf(chart)) {
      const item = document.createElement('span');
      item.style.setProperty('--colour', curve.colour);
      item.textContent = curve.name;
      key.append(item);
    }
    title.append(key);
  }
}
