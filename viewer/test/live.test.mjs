// The page in a real browser: one browser, one page for most tests. Each test begins a world of its own and waits for what
// the page counts and the simulation answers (window.imbibe), never for a time or a frame rate.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { connect } from 'node:net';
import { join } from 'node:path';
import { after as afterAll, before, test } from 'node:test';
import { ask, command, openBrowser, openPage, root, startLive, until } from './browser.mjs';
import { Watcher, processorSeconds } from './watcher.mjs';

const small = 'viewer/test/small.yaml', smallText = readFileSync(join(root, small), 'utf8');
const clothText = readFileSync(join(root, 'viewer/test/cloth.yaml'), 'utf8');
const environment = { ...process.env, IMBIBE_DATA_DIR: root };
let browser, server, page;

const send = (p, message) => p.evaluate((m) => window.imbibe.send(m), message);
const value = (p, name, swatch = 0) => p.evaluate(([n, s]) => window.imbibe.swatches[s].value(n), [name, swatch]);
const reaches = (p, name, least, swatch = 0) =>
  until(p, ([n, x, s]) => (window.imbibe.swatches[s]?.value(n) ?? -1) >= x, [name, least, swatch]);
const errors = (p) => p.evaluate(() => window.imbibe.counters.errors);
const text = (p, selector) => p.evaluate((s) => document.querySelector(s).textContent, selector);

// Paused, and the page shows the step where it is.
async function pause(p, swatch = 0) {
  const { step, time } = await ask(p, { type: 'pause', swatch });
  await until(p, (n) => window.imbibe.swatches.every((s) => (s.flags & 1) === 0) && window.imbibe.swatches[0].value('steps') === n, step);
  return { step, time };
}

async function steps(p, count) {
  const { step } = await ask(p, { type: 'step', swatch: 0, steps: count });
  await until(p, (n) => window.imbibe.swatches[0].value('steps') === n, step + count);
}

// As many steps as it takes; a run could be at its end, where no step is left, before a slow page says so.
async function stepsUntil(p, name, least) {
  while ((await value(p, name)) < least) {
    const time = await value(p, 'time_s');
    await steps(p, 20);
    assert.ok((await value(p, 'time_s')) > time, `${name} never came to ${least}`);
  }
}

// A new world of the small scene, paused at its start, all values as in the file, seen as at the start.
async function begin(p = page, scene = smallText) {
  await pause(p);
  const generation = await p.evaluate(() => window.imbibe.swatches[0].generation);
  const { errors: seen, problems } = await p.evaluate(() => window.imbibe.counters);
  await ask(p, { type: 'open', swatch: 0, name: 'small.yaml', text: scene });
  await until(p, ([g, n]) => (window.imbibe.swatches[0].generation > g && window.imbibe.swatches[0].frames > 0) || window.imbibe.counters.errors > n, [generation, seen]);
  assert.equal(await errors(p), seen, JSON.stringify(problems));
  await pause(p);
  await p.keyboard.press('Escape');
  await p.keyboard.press('f');
}

async function set(p, ...assign) {
  const seen = await p.evaluate(() => window.imbibe.counters);
  await ask(p, { type: 'set', swatch: 0, assign });  // answered after the change, or the error, was told
  const now = await p.evaluate(() => window.imbibe.counters);
  assert.ok(now.changes > seen.changes && now.errors === seen.errors, JSON.stringify(now.problems));
}

async function refused(p, act, pattern) {
  const seen = await errors(p);
  await act();
  await until(p, (n) => window.imbibe.counters.errors > n, seen);
  const problems = await p.evaluate(() => window.imbibe.counters.problems);
  assert.match(problems.map((one) => one.message).join('\n'), pattern);
  return problems;
}

async function saved(p, act) {
  const [download] = await Promise.all([p.waitForEvent('download'), act()]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}

// Where a place (m) of the first swatch is on the page.
async function pixel(p, place) {
  const box = await p.locator('#canvas').boundingBox();
  const at = await p.evaluate((x) => window.imbibe.screen(x), place);
  return [box.x + at.x, box.y + at.y];
}

before(async () => {
  browser = await openBrowser();
  server = await startLive(small, '--speed', '0');
  page = await openPage(browser, server.url, { width: 1100, height: 680 });
});
afterAll(async () => {
  await browser?.close();
  await server?.remove();
});

test('the clock waits for the first page to say run; then frames arrive', async () => {
  assert.equal(await value(page, 'time_s'), 0);
  await page.click('#run');
  await reaches(page, 'time_s', 0.004);
  assert.ok((await page.evaluate(() => window.imbibe.counters.frames)) > 1);
});

test('keys: space pauses and the clock holds, a point makes one step, R begins anew', async () => {
  await begin();
  await ask(page, { type: 'speed', limit: 0.01 });  // a slow page stops it long before its end
  await page.keyboard.press(' ');
  await reaches(page, 'steps', 3);
  await page.keyboard.press(' ');
  await until(page, () => (window.imbibe.swatches[0].flags & 1) === 0);
  const { step, time } = await ask(page, { type: 'pause', swatch: 0 });
  assert.equal((await ask(page, { type: 'save' })).step, step, 'nothing moves while it is paused');
  await page.keyboard.press('.');
  await reaches(page, 'steps', step + 1);
  assert.equal((await ask(page, { type: 'save' })).step, step + 1);
  assert.ok((await value(page, 'time_s')) > time);
  const generation = await page.evaluate(() => window.imbibe.swatches[0].generation);
  await page.keyboard.press('r');
  await until(page, (g) => window.imbibe.swatches[0].generation > g && window.imbibe.swatches[0].frames > 0, generation);
  assert.equal(await value(page, 'time_s'), 0);
  await ask(page, { type: 'speed', limit: 0 });
});

test('a speed limit holds the simulation back', async () => {
  await begin();
  await ask(page, { type: 'speed', limit: 0.01 });
  const begun = performance.now();
  await ask(page, { type: 'run', swatch: 0 });
  await reaches(page, 'time_s', 0.01);  // a second at this speed; some 0.1 s without limit
  assert.ok(performance.now() - begun > 900);
  await ask(page, { type: 'speed', limit: 0 });
});

test('every parameter of the panel comes from the description, with its unit and range', async () => {
  await begin();
  const seen = await page.evaluate(() => [...document.querySelectorAll('[data-path]')].map((e) => [e.dataset.path, e.title]));
  const described = JSON.parse(execFileSync(command, ['params', '--json'], { env: environment }));
  const known = new Set(described.map((row) => row.path ?? row.key));
  assert.ok(seen.length > 20, `only ${seen.length} parameters are shown`);
  for (const [path] of seen) assert.ok(known.has(path.replace(/\[\d+\]/g, '[]')), `${path} is not described`);
  const angle = seen.find(([path]) => path === 'textiles[0].contact_angle');
  assert.match(angle[1], /from 0 to 180 deg/);
  assert.match(angle[1], /next step/);
  await page.fill('#filter', 'particle mass');
  assert.match(await page.getAttribute('[data-path="liquid.particle_mass"]', 'title'), /begins anew/);
  await page.fill('#filter', '');
});

test('a contact angle set with the slider reaches the solver at the next step, and the uptake curve bends', async () => {
  await begin();
  await stepsUntil(page, 'yarn_kg', 3e-7);
  const { step } = await pause(page);
  const yarn = await value(page, 'yarn_kg');
  const input = page.locator('[data-path="textiles[0].contact_angle"] input');
  await input.fill('120');
  await input.press('Enter');
  await until(page, () => window.imbibe.counters.lastChange?.set[0]?.startsWith('textiles[0].contact_angle=120'));
  assert.equal(await page.evaluate(() => window.imbibe.counters.lastChange.step), step);
  await steps(page, 2);
  assert.ok((await value(page, 'yarn_kg')) < 0.01 * yarn, 'yarns that no longer wet give their liquid off');
  await stepsUntil(page, 'time_s', (await value(page, 'time_s')) + 0.006);
  assert.ok((await value(page, 'yarn_kg')) < 0.01 * yarn, 'and take none up');
  assert.ok((await value(page, 'ledger_error')) < 1e-10);
  // Begun anew, the angle is as changed.
  const generation = await page.evaluate(() => window.imbibe.swatches[0].generation);
  await page.click('#reset');
  await until(page, (g) => window.imbibe.swatches[0].generation > g && window.imbibe.swatches[0].frames > 0, generation);
  assert.equal(Math.round(await page.evaluate(() => window.imbibe.panel.value('textiles[0].contact_angle'))), 120);
});

test('a change that comes while the simulation runs is in the physics at most two steps later', async () => {
  await begin();
  await ask(page, { type: 'run', swatch: 0 });
  for (const humidity of [20, 40, 60]) {
    const done = await ask(page, { type: 'set', swatch: 0, assign: [`air.humidity=${humidity} %`] });
    assert.ok(done.step + 1 - done.arrived <= 2, JSON.stringify(done));
    assert.equal(await page.evaluate(() => window.imbibe.counters.lastChange.step), done.step);
  }
});

test('a value out of range is refused with its range', async () => {
  await begin();
  await refused(page, () => send(page, { type: 'set', swatch: 0, assign: ['air.humidity=150 %'] }), /100 %/);
  assert.match(await text(page, '#toasts .error'), /100 %/);
});

test('a click on the cloth drops a drop there', async () => {
  await begin();
  const supplied = await value(page, 'supplied_kg'), seen = await page.evaluate(() => window.imbibe.counters.changes);
  await page.keyboard.press('t');
  await page.keyboard.press('d');
  await page.fill('#drop-volume', '0.5');
  await page.mouse.click(...await pixel(page, [3e-3, 3e-3, 0.3e-3]));
  await until(page, (n) => window.imbibe.counters.changes > n, seen);
  await steps(page, 3);
  assert.ok((await value(page, 'supplied_kg')) > supplied + 4e-7);
  const made = await page.evaluate(() => window.imbibe.counters.lastChange.set[0]);
  const [x, y] = made.match(/centre: \[([^,]+), ([^,]+),/).slice(1).map(Number);
  assert.ok(Math.hypot(x - 3e-3, y - 3e-3) < 0.4e-3, made);  // a pixel is 0.03 mm; the face lies above the middle
});

test('liquid that leaves the scene is a warning', async () => {
  await begin(page, smallText + 'domain: {lower: [-12 mm, -12 mm, -3 mm], upper: [12 mm, 12 mm, 12 mm]}\n');
  assert.equal(await page.locator('#status .warning').count(), 0);
  await ask(page, { type: 'drop', swatch: 0, at: [8e-3, 0, 0], volume: 0.5e-9, speed: 0.3 });
  await ask(page, { type: 'run', swatch: 0 });
  await until(page, () => /left the domain/.test(document.querySelector('#status .warning')?.textContent ?? ''));
});

test('a picked yarn shows what it holds, even under the line that tells of a change', async () => {
  await begin();
  await page.keyboard.press('t');
  await page.keyboard.press('i');
  await set(page, 'air.humidity=40 %');
  await page.mouse.click(...await pixel(page, [-3e-3, -3e-3, 0.3e-3]));
  await page.waitForSelector('#pick:not([hidden])');
  const shown = await text(page, '#pick');
  assert.match(shown, /(yarn|Pore)/);
  for (const what of [/saturation/, /pressure/, /liquid/]) assert.match(shown, what);
  await page.keyboard.press('Escape');
  assert.equal(await page.isVisible('#pick'), false);
});

test('the picture is not blank and the page shows the eleven colours of the bar', async () => {
  await begin();
  const png = await saved(page, () => page.keyboard.press('p'));
  assert.match(png.name, /\.png$/);
  assert.equal(png.bytes.subarray(1, 4).toString(), 'PNG');
  const colours = await page.evaluate(async (bytes) => {
    const bitmap = await createImageBitmap(new Blob([new Uint8Array(bytes)]));
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height), context = canvas.getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4) seen.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return seen.size;
  }, [...png.bytes]);
  assert.ok(colours > 200, `only ${colours} colours`);
  const bar = await page.evaluate(() => [...document.querySelectorAll('#legend i')].map((e) => getComputedStyle(e).backgroundColor));
  assert.equal(bar.length, 11);
  assert.equal(new Set(bar).size, 11);
  assert.equal(bar[10], 'rgb(255, 255, 255)');
  assert.match(await text(page, '#legend'), /Liquid content\s*% of saturation/);
});

test('views by button and key; a section cuts the cloth; light and dark', async () => {
  await begin();
  const camera = () => page.evaluate(() => window.imbibe.view.camera.position.toArray());
  await page.keyboard.press('t');
  const [x, , z] = await camera();
  assert.ok(Math.abs(x) < 0.1 && z > 10, 'from above');
  await page.click('#side');
  assert.ok((await camera())[1] < -10, 'from the side');
  await page.keyboard.press('ArrowRight');
  assert.ok((await camera())[0] > 1, 'turned by a key');
  const draws = await page.evaluate(() => window.imbibe.view.draws);
  await page.keyboard.press('x');
  assert.ok(await page.isVisible('#section-place'));
  await until(page, (n) => window.imbibe.view.draws > n, draws);
  await page.keyboard.press('x');
  const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
  const before_ = await theme();
  await page.keyboard.press('l');
  assert.notEqual(await theme(), before_);
  await page.keyboard.press('l');
});

test('a bad WIF shows its error with the line, a good one dropped on the page is woven', async () => {
  await begin();
  const problems = await refused(page, () => page.evaluate(() =>
    window.imbibe.openText('bad.wif', '[WIF]\nVersion=1.1\n[WEAVING]\nShafts=oops\nTreadles=2\n')), /./);
  assert.ok(problems.some((p) => p.file === 'bad.wif' && p.line > 0), JSON.stringify(problems));
  assert.match(await text(page, '#toasts'), /bad\.wif:\d+:/);
  const good = '[WIF]\nVersion=1.1\n[CONTENTS]\nWEAVING=1\nWARP=1\nWEFT=1\nTHREADING=1\nTIEUP=1\nTREADLING=1\n[WEAVING]\nShafts=2\nTreadles=2\nRising Shed=true\n' +
    '[WARP]\nThreads=4\n[WEFT]\nThreads=4\n[THREADING]\n1=1\n2=1\n3=2\n4=2\n[TIEUP]\n1=1\n2=2\n[TREADLING]\n1=1\n2=1\n3=2\n4=2\n';
  await page.evaluate((draft) => {
    const data = new DataTransfer();
    data.items.add(new File([draft], 'basket.wif'));
    document.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
  }, good);
  await until(page, () => document.querySelector('#title').textContent === 'basket.wif' || window.imbibe.counters.problems.some((p) => p.file === 'basket.wif'));
  assert.equal(await text(page, '#title'), 'basket.wif', JSON.stringify(await page.evaluate(() => window.imbibe.counters.problems)));
});

test('a bad scene shows line and column, and a scene from the page may not name files of the server', async () => {
  await begin();
  const wrong = smallText.replace('duration: 1 s', 'duratoin: 1 s').replace('3 uL', '3 parsec');
  const problems = await refused(page, () => page.evaluate((t) => window.imbibe.openText('wrong.yaml', t), wrong), /duration/);
  assert.ok(problems.every((p) => p.file === 'wrong.yaml' && p.line > 0 && p.column > 0), JSON.stringify(problems));
  assert.ok(problems.length >= 2, 'all problems at once');
  const evil = smallText.replace('    size:', '    weave: /etc/secret.wif\n    size:');
  await refused(page, () => page.evaluate((t) => window.imbibe.openText('evil.yaml', t), evil), /may not name files/);
});

test('a scene file dropped on the page is begun', async () => {
  await begin();
  await page.evaluate((scene) => {
    const data = new DataTransfer();
    data.items.add(new File([scene], 'dropped.yaml'));
    document.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
  }, smallText.replace(/^title: .*$/m, 'title: from a file'));
  await until(page, () => document.querySelector('#title').textContent === 'from a file');
});

test('a scene of the gallery is begun from its dialog', async () => {
  await begin();
  await page.keyboard.press('g');
  assert.ok((await page.locator('.gallery button').count()) > 10);
  const generation = await page.evaluate(() => window.imbibe.swatches[0].generation);
  await page.click('.gallery button[value="seed_a/fig03_a"]');
  await until(page, (g) => window.imbibe.swatches[0].generation > g && window.imbibe.swatches[0].frames > 0, generation);
  assert.ok(await page.evaluate(() => window.imbibe.swatches[0].message.textiles.length > 0));
});

test('curves and scene are saved as files, the scene as changed', async () => {
  await begin();
  await set(page, 'textiles[0].contact_angle=70 deg');
  await steps(page, 5);
  const csv = (await saved(page, () => page.click('#csv'))).bytes.toString().trim().split('\n');
  assert.ok(csv[0].startsWith('time_s,free_kg,sorbed_kg,yarn_kg,pore_kg'), csv[0]);
  assert.ok(csv.length > 1);
  const scene = await saved(page, () => page.click('#save'));
  assert.match(scene.bytes.toString(), /contact_angle: "?70 deg/);
});

test('a soft cloth moves and darkens; pipe, wind, switches and stiffness change while it runs; its cells are picked', async () => {
  await begin(page, clothText);
  const nodes = () => page.evaluate(() => [...window.imbibe.swatches[0].cloths[0].points]);
  const start = await nodes();
  const paths = await page.evaluate(() => [...document.querySelectorAll('[data-path]')].map((e) => e.dataset.path));
  for (const path of ['liquid.pipes[0].particle_rate', 'textiles[0].wetting.cells.absorb', 'textiles[0].wetting.cells.leak', 'textiles[0].wetting.cells.bounce',
    'textiles[0].sheet.soft.cloth.air.wind', 'textiles[0].sheet.soft.cloth.hand.stretch_weft'])
    assert.ok(paths.includes(path), `${path} is not among ${paths.filter((p) => /pipe|cells|soft/.test(p))}`);
  await stepsUntil(page, 'cell_kg', 2e-6);
  const now = await nodes();
  assert.ok(Math.max(...now.map((x, i) => Math.abs(x - start[i]))) > 0.1, 'it sags');
  assert.ok(await page.evaluate(() => window.imbibe.swatches[0].cloths[0].saturation.some((s) => s > 10)), 'it is wet');
  const supplied = await value(page, 'supplied_kg');
  await set(page, 'liquid.pipes[0].particle_rate=2000', 'textiles[0].wetting.cells.absorb=false', 'textiles[0].sheet.soft.cloth.air.wind=[3 m/s, 0 m/s, 0 m/s]');
  const held = await value(page, 'cell_kg');
  await stepsUntil(page, 'supplied_kg', supplied + 2e-5);
  assert.ok((await value(page, 'supplied_kg')) < supplied + 1e-4, 'the pipe goes on where it was');
  assert.ok((await value(page, 'cell_kg')) <= held, 'it takes up no more');
  assert.ok((await value(page, 'ledger_error')) < 1e-10);
  await page.keyboard.press('i');
  const place = await page.evaluate(() => [...window.imbibe.swatches[0].cloths[0].points].slice(3 * 20, 3 * 21).map((x) => x / 1000));
  await page.mouse.click(...await pixel(page, place));
  await page.waitForSelector('#pick:not([hidden])');
  assert.match(await text(page, '#pick'), /Cell \d+ of cloth/);
});

// ---- every control that the page promises

// What the simulation has made of its start `count` steps after `assign`: all its masses, lengths and counts.
async function after(scene, assign, count = 30) {
  await begin(page, scene);
  if (assign.length > 0) await set(page, ...assign);
  const { step } = await ask(page, { type: 'step', swatch: 0, steps: count });
  await until(page, (n) => window.imbibe.swatches[0].value('steps') === n, step + count);
  return page.evaluate(() => window.imbibe.hello.columns.filter((name) => !['speed', 'step_bound', 'converged'].includes(name))
    .map((name) => `${name} ${window.imbibe.swatches[0].value(name)}`));
}

// In the panel, without "all"; and set by its input, checkbox or list it is taken and what follows differs.
async function reachesTheSolver(scene, controls, count) {
  const untouched = await after(scene, [], count);
  assert.deepEqual(await after(scene, [], count), untouched, 'the same without a change');
  const shown = await page.evaluate(() => [...document.querySelectorAll('[data-path]')].map((e) => e.dataset.path));
  for (const [path, value] of Object.entries(controls)) {
    assert.ok(shown.includes(path), `${path} is not in the panel`);
    const now = await after(scene, [`${path}=${value}`], count);
    assert.notDeepEqual(now, untouched, `${path}=${value} changes nothing`);
  }
}

test('angles, fibres, regain, air, liquid, crossings, gravity, dropper and pipe are in the panel and reach the solver', async () => {
  const scene = smallText.replace('textiles:', `  droppers: [{name: dropper, centre: [2 mm, 2 mm, 5 mm], volume: 0.3 uL, velocity: [0, 0, -2 m/s], start: 0.5 ms, interval: 1 ms, count: 100}]
  pipes: [{name: pipe, radius: 1 mm, length: 2 mm, particle_rate: 2000, speed: 0.1 m/s, transform: {rotation: [180 deg, 0 deg, 0 deg], translation: [-9 mm, 0 mm, 3 mm]}}]
solids: [{name: floor, shape: {kind: box, centre: [9 mm, 0 mm, -1 mm], size: [4 mm, 4 mm, 2 mm]}}]
textiles:`).replace('    - {centre: [0 mm, 0 mm, 1.3 mm], volume: 3 uL, velocity: [0, 0, -0.1 m/s]}',
    `    - {centre: [0 mm, 0 mm, 1.3 mm], volume: 3 uL, velocity: [0, 0, -0.1 m/s]}
    - {centre: [9 mm, 0 mm, 0.85 mm], volume: 2 uL}`);
  await reachesTheSolver(scene, {
    'textiles[0].contact_angle': '70 deg', 'textiles[0].warp_contact_angle': '70 deg', 'textiles[0].weft_contact_angle': '70 deg',
    'textiles[0].warp.fibre': 'wool', 'textiles[0].weft.fibre': 'wool', 'textiles[0].regain': '15 %',
    'solids[0].contact_angle': '30 deg', 'air.humidity': '20 %', 'air.temperature': '35 degC',
    'liquid.kind.surface_tension': '40 mN/m', 'liquid.kind.viscosity': '3 mPa.s',
    'textiles[0].wetting.network.crossing_factor': '1', 'textiles[0].wetting.network.evaporation': 'false',
    gravity: '[0 m/s2, 3 m/s2, -9 m/s2]', 'liquid.droppers[0].volume': '0.6 uL', 'liquid.droppers[0].interval': '1.5 ms',
    'liquid.droppers[0].centre': '[2 mm, -2 mm, 2 mm]', 'liquid.pipes[0].particle_rate': '4000',
  }, 150);
});

test('cloth stiffness, wind, absorb, leak and bounce are in the panel and reach the solver', async () => {
  await reachesTheSolver(clothText, {
    'textiles[0].sheet.soft.cloth.hand.stretch_weft': '40 N/m', 'textiles[0].sheet.soft.cloth.hand.shear': '1 N/m',
    'textiles[0].sheet.soft.cloth.air.wind': '[4 m/s, 0 m/s, 0 m/s]', 'textiles[0].wetting.cells.absorb': 'false',
  }, 60);
  await begin(page, clothText);
  const shown = await page.evaluate(() => [...document.querySelectorAll('[data-path]')].map((e) => e.dataset.path));
  for (const path of ['absorb', 'leak', 'bounce']) assert.ok(shown.includes(`textiles[0].wetting.cells.${path}`), path);
});

test('absorb, leak and bounce switched off by a click in the page do what they say', async () => {
  // A cloth that can hold little, under a pipe that gives much.
  const scene = clothText.replace('cells: {resistance: 100}', 'cells: {resistance: 100, capacity: 20 g/m2, drop_neck: 0 mm, leak_time: 10 ms}')
    .replace('particle_rate: 200', 'particle_rate: 2000').replace('volume: 0.2 mL', 'volume: 0.4 mL');
  const taking = scene.replace('cells: {', 'cells: {bounce: false, ');  // full cells that throw back hardly grow over-full
  const held = async (path, text = scene) => {
    await begin(page, text);
    if (path) {
      const seen = await page.evaluate(() => window.imbibe.counters.changes);
      const box = page.locator(`[data-path="textiles[0].wetting.cells.${path}"] input[type=checkbox]`);
      await box.scrollIntoViewIfNeeded();
      await box.click();
      await until(page, (n) => window.imbibe.counters.changes > n, seen);
      assert.deepEqual(await page.evaluate(() => window.imbibe.counters.lastChange.set), [`textiles[0].wetting.cells.${path}=false`]);
    }
    await stepsUntil(page, 'time_s', 0.25);
    assert.ok((await value(page, 'ledger_error')) < 1e-10);
    return value(page, 'cell_kg');
  };
  const all = await held('');
  assert.ok(all > 5e-5, `${all} kg: 72 mg fill it`);
  assert.equal(await held('absorb'), 0, 'nothing is taken up');
  assert.ok((await held('leak', taking)) > 2 * (await held('', taking)), 'over-full cells keep what they would have let go');
  assert.ok((await held('bounce')) > 1.05 * all, 'full cells take what they would have thrown back');
});

test('regain is pulled with the slider: dry fibres follow at the next step, the air has the difference', async () => {
  await begin();
  await stepsUntil(page, 'yarn_kg', 1e-7);
  const { step } = await pause(page);
  const before_ = { sorbed: await value(page, 'sorbed_kg'), evaporated: await value(page, 'evaporated_kg') };
  const shown = await page.evaluate(() => window.imbibe.panel.value('textiles[0].regain'));
  assert.ok(shown > 6 && shown < 9, `cotton in air of 65 %, not ${shown}`);
  const input = page.locator('[data-path="textiles[0].regain"] input');
  await input.fill('12');
  await input.press('Enter');
  await until(page, () => window.imbibe.counters.lastChange?.set[0]?.startsWith('textiles[0].regain=12'));
  assert.equal(await page.evaluate(() => window.imbibe.counters.lastChange.step), step);
  await steps(page, 1);
  const gained = (await value(page, 'sorbed_kg')) - before_.sorbed, given = before_.evaporated - (await value(page, 'evaporated_kg'));
  assert.ok(gained > 0.2 * before_.sorbed, `${gained} kg of ${before_.sorbed}`);
  assert.ok(Math.abs(gained - given) < 0.02 * gained, `${gained} kg into the fibres, ${given} kg from the air`);
  assert.ok((await value(page, 'ledger_error')) < 1e-10);
  await page.keyboard.press('Escape');
  await page.keyboard.press('t');
  await page.keyboard.press('i');
  await page.mouse.click(...await pixel(page, [-3.9e-3, -3.9e-3, 0.3e-3]));
  await page.waitForSelector('#pick:not([hidden])');
  const pick = await text(page, '#pick');
  if (/regain/.test(pick)) assert.match(pick, /regain1[12]\.\d/);
  await page.keyboard.press('Escape');
});

test('help by key and button tells the keys, and closes by Esc and by its button', async () => {
  await begin();
  await page.keyboard.press('?');
  assert.ok(await page.isVisible('#dialog'));
  const told = await text(page, '#dialog');
  for (const what of [/Keys and mouse/, /run or pause/, /one step/, /reset/, /drops a drop/, /section/, /picture/, /compare/, /light or dark/]) assert.match(told, what);
  await page.keyboard.press(' ');
  assert.equal((await page.evaluate(() => window.imbibe.swatches[0].flags)) & 1, 0, 'keys go to the dialog meanwhile');
  await page.keyboard.press('Escape');
  if (await page.isVisible('#dialog')) await page.keyboard.press('Escape');
  assert.equal(await page.isVisible('#dialog'), false);
  await page.click('#help');
  await page.click('#dialog footer button');
  assert.equal(await page.isVisible('#dialog'), false);
});

test('the yarns of a network on a soft sheet move, and its pores are picked where they are', async () => {
  await begin();
  const generation = await page.evaluate(() => window.imbibe.swatches[0].generation);
  await ask(page, { type: 'open', swatch: 0, gallery: 'cloth/network_on_hammock' });
  await until(page, (g) => window.imbibe.swatches[0].generation > g && window.imbibe.swatches[0].frames > 0, generation);
  const heights = () => page.evaluate(() => { const p = window.imbibe.swatches[0].yarns[0].points; return [0, 1, 2, 3, 4, 5].map((i) => p[4 * 500 * i + 2]); });
  const before_ = await heights();
  await steps(page, 40);
  const after_ = await heights();
  assert.ok(after_.some((z, i) => Math.abs(z - before_[i]) > 1e-3), `${before_} mm, then ${after_} mm`);
  // The frames tell where the sheet is; the page finds the yarns on it where the simulation has them.
  const { largest, count, middles } = await page.evaluate(() => {
    const s = window.imbibe.swatches[0], yarns = s.yarns[0], rings = yarns.info.steps_per_segment, middles = [];
    for (const yarn of [0, 17, 60, yarns.firstSegment.length - 2])
      for (const k of [0, 20]) {
        const p = 4 * (yarns.firstPoint[yarn] + k * rings + rings / 2);
        middles.push({ node: yarns.firstSegment[yarn] + k, at: [...yarns.points.slice(p, p + 3)] });
      }
    return { largest: s.frameBytes / s.frames, count: yarns.count, middles };
  });
  assert.ok(largest < 3 * count, `${largest} bytes a frame for ${count} points`);
  for (const { node, at } of middles) {
    const place = await page.evaluate((n) => window.imbibe.inspect(0, n), node);
    assert.ok(Math.hypot(...place.map((x, k) => 1000 * x - at[k])) < 0.02, `segment ${node}: ${place.map((x) => 1000 * x)} mm, on the page ${at}`);
  }
  await page.keyboard.press('t');
  await page.keyboard.press('i');
  const pore = await page.evaluate(() => {
    const s = window.imbibe.swatches[0], size = s.pores[0].count, p = s.pores[0].places();
    const middle = Array.from({ length: size }, (_, i) => i).sort((a, b) => Math.hypot(p[3 * a], p[3 * a + 1]) - Math.hypot(p[3 * b], p[3 * b + 1]))[0];
    return { number: middle, place: [0, 1, 2].map((k) => p[3 * middle + k]) };
  });
  await page.mouse.click(...await pixel(page, pore.place.map((x) => x / 1000)));
  await page.waitForSelector('#pick:not([hidden])');
  const shown = await text(page, '#pick');
  assert.match(shown, /Pore of hammock/);
  const told = shown.match(/place(-?[\d.]+), (-?[\d.]+), (-?[\d.]+) mm/).slice(1).map(Number);
  assert.ok(Math.abs(told[2]) > 0.5, `the middle has sagged: ${told}`);
  assert.ok(Math.hypot(...told.map((x, k) => x - pore.place[k])) < 0.15, `the page has it at ${pore.place}, the simulation at ${told}`);
  await page.keyboard.press('Escape');
});

test('1000 malformed messages are answered, counted and survived', async () => {
  await begin();
  const watcher = await Watcher.open(server.url);
  const rubbish = ['', '{', '[]', '{}', '{"type":7}', '{"type":"set"}', '{"type":"set","assign":[1]}', '{"type":"drop","at":[1e999,0,0]}',
    `{"type":"${'x'.repeat(5000)}"}`, '['.repeat(2000), '{"type":"seek","time":"now"}', '\u0000', '{"type":"save","ask":-1}'];
  for (let i = 0; i < 1000; ++i) watcher.send(rubbish[i % rubbish.length]);
  await watcher.until(() => watcher.count('error') >= 1000);
  watcher.close();
  await steps(page, 1);
});

test('two viewers watch, one holds the controls and may hand them over', async () => {
  await begin();
  const second = await openPage(browser, server.url, { width: 800, height: 600 });
  await until(second, () => window.imbibe.holder !== 0);
  assert.equal(await second.evaluate(() => window.imbibe.holder === window.imbibe.hello.viewer), false);
  await refused(second, () => send(second, { type: 'reset', swatch: 0 }), /controls/);
  await ask(second, { type: 'take' });
  await until(second, () => window.imbibe.holder === window.imbibe.hello.viewer);
  await until(page, () => window.imbibe.holder !== window.imbibe.hello.viewer);
  const { step } = await ask(second, { type: 'step', swatch: 0, steps: 5 });
  await reaches(page, 'steps', step + 5);
  // One that comes late has the curves from the start.
  const third = await Watcher.open(server.url);
  await third.until(() => third.count('history') === 1);
  third.close();
  assert.deepEqual(second.problems, []);
  await second.close();
  await until(page, () => window.imbibe.holder === window.imbibe.hello.viewer);
});

test('two swatches are compared: same drops, neither runs ahead', async () => {
  await begin();
  await page.keyboard.press('c');
  await page.fill('dialog input[name="textiles[0].contact_angle"]', '60');
  await page.click('dialog button[value=go]');
  await until(page, () => window.imbibe.swatches.length === 2 && window.imbibe.swatches[1].frames > 0);
  await reaches(page, 'time_s', 0.01, 0);
  await reaches(page, 'time_s', 0.01, 1);
  await ask(page, { type: 'pause', swatch: 255 });
  await until(page, () => window.imbibe.swatches.every((s) => (s.flags & 1) === 0));
  const [left, right] = [await value(page, 'time_s', 0), await value(page, 'time_s', 1)];
  assert.ok(Math.abs(left - right) < 0.02, `${left} s and ${right} s`);
  assert.equal(await value(page, 'supplied_kg', 0), await value(page, 'supplied_kg', 1));
  assert.match(await text(page, '#labels'), /left:.*right:.*60/s);
  const [views, bar] = await page.evaluate(() => [document.querySelector('#canvas').getBoundingClientRect().left + 2 * window.imbibe.view.area(0).z,
    document.querySelector('#legend').getBoundingClientRect().left]);
  assert.ok(views <= bar, `the views end at ${views}, the colour bar begins at ${bar}`);
  await ask(page, { type: 'compare', on: false });
  await until(page, () => window.imbibe.swatches.length === 1);
});

test('the page comes back when the server has been away', async () => {
  const connects = await page.evaluate(() => window.imbibe.counters.connects);
  const { port } = server;
  await server.remove();
  await until(page, () => document.body.classList.contains('away'));
  server = await startLive(small, '--speed', '0', '--port', String(port));
  await until(page, (n) => window.imbibe.counters.connects > n, connects);
  await until(page, () => window.imbibe.swatches[0]?.frames > 0 && window.imbibe.swatches[0].value('time_s') === 0);
});

test('what was done live is recorded, and runs again offline to the same bits', async () => {
  await page.click('#record');
  await until(page, () => (window.imbibe.swatches[0].flags & 16) !== 0);
  await ask(page, { type: 'speed', limit: 0.02 });  // a slow page makes its changes long before the end
  await send(page, { type: 'run', swatch: 0 });
  await reaches(page, 'time_s', 0.006);
  await set(page, 'textiles[0].contact_angle=75 deg', 'air.humidity=30 %');
  await ask(page, { type: 'drop', swatch: 0, at: [-3e-3, 1e-3, 0.3e-3], volume: 0.6e-9, speed: 0.1 });
  await reaches(page, 'time_s', 0.02);
  await set(page, 'textiles[0].regain=13 %', 'textiles[0].weft_contact_angle=60 deg');
  await set(page, 'gravity=[2 m/s2, 0 m/s2, -9.81 m/s2]', 'liquid.kind.surface_tension=40 mN/m');
  await reaches(page, 'time_s', 0.03);
  await server.stop();
  const folder = join(server.folder, 'run'), again = join(server.folder, 'again');
  assert.ok(readdirSync(folder).filter((f) => /^liquid_\d+\.vtp$/.test(f)).length > 10, 'as `imbibe run` writes it');
  execFileSync(command, ['run', join(folder, 'scene.yaml'), '--changes', join(folder, 'changes.jsonl'), '-o', again, '--no-pictures', '--threads', '1'],
    { env: environment, stdio: 'pipe' });
  const read = (f) => JSON.parse(readFileSync(join(f, 'run.json'), 'utf8'));
  assert.equal(read(again).steps, read(folder).steps);
  assert.equal(read(again).state_hash, read(folder).state_hash);
  assert.ok(readFileSync(join(folder, 'changes.jsonl'), 'utf8').split('\n').length >= 5);
});

test('a finished run is replayed: play, pause, any time', async () => {
  const again = join(server.folder, 'again');
  assert.ok(existsSync(join(again, 'run.json')));
  const replay = await startLive(again, '--speed', '0');
  try {
    const p = await openPage(browser, replay.url, { width: 900, height: 600 });
    await reaches(p, 'time_s', 0.029);
    await ask(p, { type: 'pause' });
    await ask(p, { type: 'seek', time: 0.011 });
    await until(p, () => Math.abs(window.imbibe.swatches[0].value('time_s') - 0.010) < 1e-9);
    assert.ok(await p.isVisible('#seek'));
    assert.ok((await p.evaluate(() => window.imbibe.swatches[0].series.last('time_s'))) > 0.025, 'the curves stay those of the whole run');
    await p.keyboard.press('t');
    const middle = await p.evaluate(() => [...window.imbibe.swatches[0].yarns[0].points.slice(4 * 2000, 4 * 2000 + 3)].map((x) => x / 1000));
    await p.mouse.click(...await pixel(p, middle));
    await p.waitForSelector('#pick:not([hidden])');
    assert.match(await text(p, '#pick'), /saturation.*pressure.*fibrecotton.*regain/s);
    assert.ok(!(await p.isVisible('#panel')));
    await refused(p, () => send(p, { type: 'set', assign: ['air.humidity=10 %'] }), /finished run/);
    assert.deepEqual(p.problems, []);
    await p.close();
  } finally {
    await replay.remove();
  }
});

function talk(port, request) {
  return new Promise((done) => {
    let reply = '';
    const socket = connect(port, '127.0.0.1', () => socket.write(request));
    socket.on('data', (data) => {
      reply += data.toString('latin1');
      if (reply.startsWith('HTTP/1.1 101')) socket.destroy();  // speaks WebSocket from here on
    });
    socket.on('close', () => done(reply));
    socket.on('error', () => done(reply));
  });
}

test('only pages of this server may use it, and only with the token where one is needed', async () => {
  const guarded = await startLive(small, '--listen', '0.0.0.0', '--token', 'letmein');
  try {
    const { port } = guarded;
    const upgrade = (path, host = `127.0.0.1:${port}`, origin = '') =>
      `GET ${path} HTTP/1.1\r\nHost: ${host}\r\n${origin ? `Origin: ${origin}\r\n` : ''}Upgrade: websocket\r\nConnection: Upgrade\r\n` +
      'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n';
    assert.match(await talk(port, upgrade('/live')), /^HTTP\/1\.1 403/);
    assert.match(await talk(port, upgrade('/live?token=wrong')), /^HTTP\/1\.1 403/);
    assert.match(await talk(port, upgrade('/live?token=letmein', `127.0.0.1:${port}`, 'http://evil.example')), /^HTTP\/1\.1 403/);
    assert.match(await talk(port, upgrade('/live?token=letmein')), /^HTTP\/1\.1 101[^]*s3pPLMBiTxaQ9kYGzzhZRbK\+xOo=/);
    const get = (path, method = 'GET') => talk(port, `${method} ${path} HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n\r\n`);
    assert.match(await get('/'), /^HTTP\/1\.1 200/);
    assert.match(await get('/../../etc/passwd'), /^HTTP\/1\.1 404/);
    assert.match(await get('/%2e%2e/etc/passwd'), /^HTTP\/1\.1 404/);
    assert.match(await get('/', 'POST'), /^HTTP\/1\.1 405/);
    assert.match(await talk(port, 'nonsense\r\n\r\n'), /^HTTP\/1\.1 400/);
    assert.match(await talk(port, `GET /${'x'.repeat(9000)}`), /^HTTP\/1\.1 431/);
    assert.match(guarded.output(), /\?token=letmein/);
  } finally {
    await guarded.remove();
  }
  const own = await startLive(small);
  try {
    assert.match(await talk(own.port, `GET / HTTP/1.1\r\nHost: evil.example:${own.port}\r\n\r\n`), /^HTTP\/1\.1 403/);
  } finally {
    await own.remove();
  }
});

// Processor times, which other work on the machine changes little. The server may use a twentieth of a core per viewer
// at 30 frames a second (viewer/tools/measure.mjs measures it on the scenes of the README): 1.7 ms a frame.
test('twenty viewers all get frames, and serving them costs less than the twentieth of a core each that it may', async () => {
  const busy = await startLive(small, '--speed', '0', '--threads', '1', '--run', '--set', 'duration=100 s', '--set', 'output.every=10 s',
    '--set', 'liquid.droppers[0]={centre: [0 mm, 0 mm, 3 mm], volume: 0.5 uL, interval: 20 ms, count: 5000}');  // or it rests, and soon ends
  try {
    const watchers = await Promise.all(Array.from({ length: 20 }, () => Watcher.open(busy.url)));
    const before_ = processorSeconds(busy.child.pid).server;
    await Promise.all(watchers.map((w) => w.until(() => w.frames >= 15)));
    const frames = watchers.reduce((sum, w) => sum + w.frames, 0);
    const each = (processorSeconds(busy.child.pid).server - before_) / frames;
    assert.ok(each < 0.05 / 30, `${1e3 * each} ms a frame`);
    watchers.forEach((w) => w.close());
  } finally {
    await busy.remove();
  }
});

test('the page wrote no error to the console', () => {
  // A server that goes away is told by the browser itself.
  assert.deepEqual(page.problems.filter((line) => !/ERR_CONNECTION_REFUSED|WebSocket connection/.test(line)), []);
});
