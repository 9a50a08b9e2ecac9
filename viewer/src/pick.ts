// What a picked yarn or pore holds.
import type { InspectMessage } from './protocol';
import { escape, withPrefix } from './text';

export function showPick(element: HTMLElement, m: InspectMessage, close: () => void): void {
  const rows: [string, string][] = [];
  const percent = (x: number) => `${(100 * x).toFixed(1)} %`;
  rows.push(['saturation', percent(m.saturation)]);
  rows.push(['liquid', withPrefix(1e3 * m.liquid_kg, 'g') + (m.capacity_kg === undefined ? '' : ` of ${withPrefix(1e3 * m.capacity_kg, 'g')}`)]);
  if (m.pressure !== undefined) rows.push(['pressure', withPrefix(m.pressure, 'Pa')]);
  if (m.kind === 'cell') {
    rows.push(['dry cloth', withPrefix(1e3 * (m.dry_kg ?? 0), 'g')]);
    rows.push(['speed', withPrefix(m.speed ?? 0, 'm/s')]);
  } else if (m.kind === 'pore') {
    rows.push(['throat radius', withPrefix(m.throat ?? 0, 'm')]);
    if (m.opening) rows.push(['opening', `${withPrefix(m.opening[0], 'm')} × ${withPrefix(m.opening[1], 'm')}`]);
  } else {
    rows.push(['fibre', escape(m.fibre ?? '')]);
    rows.push(['regain', percent(m.regain ?? 0)]);
    rows.push(['sorbed', withPrefix(1e3 * (m.sorbed_kg ?? 0), 'g')]);
    rows.push(['contact angle', `${(((m.contact_angle ?? 0) * 180) / Math.PI).toFixed(1)}°`]);
    rows.push(['yarn radius', withPrefix(m.radius ?? 0, 'm')]);
  }
  rows.push(['place', m.place.map((x) => (1e3 * x).toFixed(2)).join(', ') + ' mm']);
  const title = m.kind === 'cell' ? `Cell ${m.node} of ${escape(m.name)}` : m.kind === 'pore' ? `Pore of ${escape(m.name)}` : `${m.kind === 'warp' ? 'Warp' : 'Weft'} yarn ${m.yarn}, half loop ${m.segment} of ${escape(m.name)}`;
  element.innerHTML = `<button aria-label="Close" title="Close (Esc)">×</button><h2>${title}</h2><table>` +
    rows.map(([name, value]) => `<tr><th>${name}</th><td>${value}</td></tr>`).join('') + '</table>';
  element.querySelector('button')!.onclick = close;
  element.hidden = false;
}
