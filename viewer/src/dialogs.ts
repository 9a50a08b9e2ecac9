// Dialogs: scenes to start from, what to compare, keys.
import { byId } from './dom';
import type { ControlRow } from './protocol';
import { escape } from './text';

function show(html: string): HTMLDialogElement {
  const dialog = byId<HTMLDialogElement>('dialog');
  dialog.innerHTML = `<form method="dialog">${html}</form>`;
  dialog.onclick = (e) => { if (e.target === dialog) dialog.close(); };
  dialog.showModal();
  return dialog;
}

export function galleryDialog(scenes: { id: string; title: string }[], open: (id: string) => void, openFile: (file: File) => void): void {
  const names: Record<string, string> = { quickstart: 'Start here', extra: 'More cloths and liquids', cloth: 'Soft cloth', seed_b: 'A pipe on soft cloth: seed B',
    seed_a: 'Drops on wool and polyester: figures of seed A', verify: 'Cases with a known answer' };
  const order = Object.keys(names), rank = (folder: string) => (order.indexOf(folder) + order.length + 1) % (order.length + 1);
  const folders = [...new Set(scenes.map((s) => s.id.split('/')[0] ?? ''))].sort((a, b) => rank(a) - rank(b));
  const dialog = show(`<h2>Scenes to start from</h2><div class="gallery">` + folders.map((folder) =>
    `<h3>${escape(names[folder] ?? folder)}</h3><div>` + scenes.filter((s) => s.id.startsWith(`${folder}/`)).sort((a, b) => (folder === 'quickstart' ? a.title.localeCompare(b.title) : 0)).map((s) =>
      `<button value="${escape(s.id)}"><b>${escape((s.id.split('/')[1] ?? s.id).replaceAll('_', ' '))}</b><span>${escape(s.title)}</span></button>`).join('') + '</div>').join('') +
    `</div><footer><label class="file">Open a .wif draft or scene file<input type="file" accept=".wif,.yaml,.yml,.json" /></label><button value="">Close</button></footer>`);
  dialog.onclose = () => { if (dialog.returnValue) open(dialog.returnValue); dialog.returnValue = ''; };
  dialog.querySelector<HTMLButtonElement>('.gallery button')?.focus();
  dialog.querySelector('input')!.onchange = (e) => {
    const file = (e.target as HTMLInputElement).files?.[0];
    if (file) openFile(file);
    dialog.close('');
  };
}

// The second swatch: the scene with other fibres or another weave.
export function compareDialog(rows: ControlRow[], begin: (assignments: string[]) => void): void {
  const wanted = rows.filter((r) => /^textiles\[0\]\.(weave|warp\.fibre|weft\.fibre|contact_angle|sheet\.soft\.preset|wetting\.cells\.(absorption_factor|capacity_ratio))$/.test(r.path));
  const dialog = show(`<h2>Compare with a second swatch</h2><p>The same scene and the same drops; what is different on the right:</p><div class="fields">` +
    wanted.map((r) => `<label><span>${escape(r.path.replace('textiles[0].', '').replaceAll(/[_.]/g, ' '))}${r.unit ? ` (${escape(r.unit)})` : ''}</span>` +
      (r.choices ? `<select name="${escape(r.path)}">${r.choices.map((c) => `<option${c === (r.text ?? '').replaceAll('"', '') ? ' selected' : ''}>${escape(c)}</option>`).join('')}</select>`
        : `<input name="${escape(r.path)}" placeholder="as on the left" value="" list="list-${escape(r.path)}" />`) + '</label>').join('') +
    `</div><p class="hint">weave: plain, twill 2/1, satin 5/2, basket 2/2, or rows like 10 01</p><footer><button value="">Cancel</button><button value="go" class="primary">Begin both</button></footer>`);
  dialog.onclose = () => {
    if (dialog.returnValue !== 'go') return;
    const assignments: string[] = [];
    for (const field of dialog.querySelectorAll<HTMLInputElement | HTMLSelectElement>('input, select')) {
      const row = wanted.find((r) => r.path === field.name), value = field.value.trim();
      if (!row || value === '' || value === (row.text ?? '').replaceAll('"', '')) continue;
      assignments.push(`${row.path}=${row.kind === 'number' ? `${value} ${row.unit ?? ''}` : JSON.stringify(value)}`);
    }
    dialog.returnValue = '';
    begin(assignments);
  };
}

export function helpDialog(): void {
  const keys: [string, string][] = [['space', 'run or pause'], ['.', 'one step'], ['R', 'reset: begin anew with the values as they are'], ['G', 'scenes'],
    ['D / I', 'click drops a drop / looks into a yarn or pore'], ['F / T / S', 'fit / from above / from the side'], ['X', 'section through the cloth'],
    ['arrows, + −', 'turn, zoom'], ['P', 'picture'], ['C', 'compare two swatches'], ['L', 'light or dark'], ['Esc', 'close what is open']];
  show(`<h2>Keys and mouse</h2><table>${keys.map(([k, what]) => `<tr><th>${escape(k)}</th><td>${escape(what)}</td></tr>`).join('')}
    <tr><th>mouse</th><td>left turns, right moves, wheel zooms; one finger turns, two move and zoom</td></tr></table>
    <p class="hint">A parameter with ⟲ cannot change while the cloth gets wet: changing it begins anew.</p><footer><button value="">Close</button></footer>`);
}
