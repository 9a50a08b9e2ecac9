// The colour bar: eleven colours of what a yarn holds, white for none, with unit and limits.
import type { HelloMessage } from './protocol';
import { byId } from './dom';

export function drawLegend(bar: HelloMessage['bar']): void {
  const over = (c: [number, number, number, number]) =>
    `rgb(${[0, 1, 2].map((k) => Math.round(255 * (c[3] * c[k]! + 1 - c[3]))).join(',')})`;
  const rows = bar.map((c, level) => ({ level, colour: over(c) })).slice(1).reverse();
  byId('legend').innerHTML = `<h2>Liquid content</h2><p>% of saturation</p><ol>` +
    rows.map((r) => `<li><i style="background:${r.colour}"></i><span>${r.level * 10}</span></li>`).join('') +
    `<li class="none"><i style="background:${over(bar[0]!)}"></i><span>0</span></li></ol>`;
}
