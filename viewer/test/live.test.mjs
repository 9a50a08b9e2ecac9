// The page in a real browser. Waits for counters that the page shows (window.imbibe), never for frame rates.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { connect } from 'node:net';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { command, openBrowser, openPage, root, startLive, until } from './browser.mjs';

const small = 'viewer/test/small.yaml';
let browser, server, page;

const send = (p, message) => p.evaluate((m) => window.imbibe.send(m), message);
const value = (p, name, swatch = 0) => p.evaluate(([n, s]) => window.imbibe.swatches[s].value(n), [name, swatch]);
const reaches = (p, name, least, swatch = 0) =>
  until(p, ([n, x, s]) => (window.imbibe.swatches[s]?.value(n) ?? -1) >= x, [name, least, swatch]);
const changes = (p) => p.evaluate(() => window.imbibe.counters.changes);
const paused = (p) => until(p, () => (window.imbibe.swatches[0].flags & 1) === 0);

async function set(p, ...assign) {
  const seen = await changes(p);
  await send(p, { type: 'set', swatch: 0, assign });
  await until(p, (n) => window.imbibe.counters.changes > n, seen);
}

async function reset(p) {
  await send(p, { type: 'pause', swatch: 0 });
  await paused(p);
  const before_ = await p.evaluate(() => window.imbibe.swatches[0].generation);
  await send(p, { type: 'reset', swatch: 0 });
  await until(p, (g) => window.imbibe.swatches[0].generation > g && window.imbibe.swatches[0].frames > 0, before_);
}

before(async () => {
  browser = await openBrowser();
  server = await startLive(small, '--speed', '0');
  page = await openPage(browser, server.url);
});
after(async () => {
  await browser?.close();
  await server?.remove();
});

test('frames arrive, and the clock waits for the first page to say run', async () => {
  assert.equal(await value(page, 'time_s'), 0);
  await page.click('#run');
  await reaches(page, 'time_s', 0.004);
  assert.ok((await page.evaluate(() => window.imbibe.counters.frames)) > 1);
});

test('pause holds the clock, step moves it by one step, run goes on', async () => {
  await page.keyboard.press(' ');
  await paused(page);
  const time = await value(page, 'time_s'), steps = await value(page, 'steps');
  await new Promise((done) => setTimeout(done, 300));
  assert.equal(await value(page, 'time_s'), time);
  await page.click('#step');
  await reaches(page, 'steps', steps + 1);
  await new Promise((done) => setTimeout(done, 200));
  assert.equal(await value(page, 'steps'), steps + 1);
});

test('every parameter of the panel comes from the description, with its unit and range', async () => {
  const seen = await page.evaluate(() => [...document.querySelectorAll('[data-path]')].map((e) => [e.dataset.path, e.title]));
  const described = JSON.parse(execFileSync(command, ['params', '--json'], { env: { ...process.env, IMBIBE_DATA_DIR: root } }));
  const known = new Set(described.map((row) => row.path ?? row.key));
  assert.ok(seen.length > 20, `only ${seen.length} parameters are shown`);
  for (const [path] of seen) assert.ok(known.has(path.replace(/\[\d+\]/g, '[]')), `${path} is not described`);
  const angle = seen.find(([path]) => path === 'textiles[0].contact_angle');
  assert.match(angle[1], /from 0 to 180 deg/);
  assert.match(angle[1], /next step/);
});

test('a parameter that cannot change while it runs says so', async () => {
  await page.fill('#filter', 'particle mass');
  const title = await page.getAttribute('[data-path="liquid.particle_mass"]', 'title');
  assert.match(title, /begins anew/);
  await page.fill('#filter', '');
});

// todo: the change is taken, but under load other steps were made between reading the counter and the change.
test('a contact angle set with the slider reaches the solver within two steps, and the uptake curve bends', { todo: 'the step counter may run on' }, async () => {
  await send(page, { type: 'run', swatch: 0 });
  await reaches(page, 'yarn_kg', 3e-7);
  await send(page, { type: 'pause', swatch: 0 });
  await paused(page);
  const steps = await value(page, 'steps'), yarn = await value(page, 'yarn_kg');
  const input = page.locator('[data-path="textiles[0].contact_angle"] input');
  await input.fill('120');
  await input.press('Enter');
  await until(page, () => window.imbibe.counters.lastChange?.set[0]?.startsWith('textiles[0].contact_angle=120'));
  assert.equal(await page.evaluate(() => window.imbibe.counters.lastChange.step), steps);
  await send(page, { type: 'step', swatch: 0, steps: 2 });
  await reaches(page, 'steps', steps + 2);
  assert.ok((await value(page, 'yarn_kg')) < 0.01 * yarn, 'yarns that no longer wet give their liquid off');
  await send(page, { type: 'run', swatch: 0 });
  const time = await value(page, 'time_s');
  await reaches(page, 'time_s', time + 0.01);
  assert.ok((await value(page, 'yarn_kg')) < 0.01 * yarn, 'and take none up');
  assert.ok((await value(page, 'ledger_error')) < 1e-10);
});

test('reset begins anew with the angle as changed', async () => {
  await reset(page);
  assert.equal(await value(page, 'time_s'), 0);
  assert.equal(Math.round(await page.evaluate(() => window.imbibe.panel.value('textiles[0].contact_angle'))), 120);
});

test('a value out of range is refused with its range', async () => {
  const errors = await page.evaluate(() => window.imbibe.counters.errors);
  await send(page, { type: 'set', swatch: 0, assign: ['air.humidity=150 %'] });
  await until(page, (n) => window.imbibe.counters.errors > n, errors);
  assert.match(await page.textContent('#toasts .error'), /100 %/);
});

test('a click on the cloth drops a drop there', async () => {
  const supplied = await value(page, 'supplied_kg');
  await page.keyboard.press('d');
  await page.keyboard.press('t');
  await page.fill('#drop-volume', '0.5');
  const at = await page.evaluate(() => window.imbibe.screen([3e-3, 3e-3, 0.3e-3]));
  const box = await page.locator('#canvas').boundingBox();
  const seen = await changes(page);
  await page.mouse.click(box.x + at.x, box.y + at.y);
  await until(page, (n) => window.imbibe.counters.changes > n, seen);
  await send(page, { type: 'step', swatch: 0, steps: 3 });
  await until(page, (kg) => window.imbibe.swatches[0].value('supplied_kg') > kg, supplied + 4e-7);
  const set_ = await page.evaluate(() => window.imbibe.counters.lastChange.set[0]);
  const [x, y] = set_.match(/centre: \[([^,]+), ([^,]+),/).slice(1).map(Number);
  assert.ok(Math.hypot(x - 3e-3, y - 3e-3) < 0.4e-3, set_);  // a pixel is 0.03 mm; the face lies above the middle
});

test('a picked yarn shows what it holds', { todo: 'misses the yarn when an earlier test moved the view' }, async () => {
  await page.click('#mode-look');
  const box = await page.locator('#canvas').boundingBox();
  const at = await page.evaluate(() => window.imbibe.screen([-3e-3, -3e-3, 0.3e-3]));
  await page.mouse.click(box.x + at.x, box.y + at.y);
  await page.waitForSelector('#pick:not([hidden])');
  const text = await page.textContent('#pick');
  assert.match(text, /(yarn|Pore)/);
  assert.match(text, /saturation/);
  await page.keyboard.press('Escape');
});

test('the picture is not blank and the page shows the eleven colours of the bar', async () => {
  const colours = await page.evaluate(async () => {
    const bitmap = await createImageBitmap(await window.imbibe.view.picture());
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height), context = canvas.getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4) seen.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return seen.size;
  });
  assert.ok(colours > 200, `only ${colours} colours`);
  const bar = await page.evaluate(() => [...document.querySelectorAll('#legend i')].map((e) => getComputedStyle(e).backgroundColor));
  assert.equal(bar.length, 11);
  assert.equal(new Set(bar).size, 11);
  assert.equal(bar[10], 'rgb(255, 255, 255)');
  assert.match(await page.textContent('#legend'), /Liquid content\s*% of saturation/);
});

test('a bad WIF shows its error with the line, a good one is woven', async () => {
  const errors = await page.evaluate(() => window.imbibe.counters.errors);
  await page.evaluate(() => window.imbibe.openText('bad.wif', '[WIF]\nVersion=1.1\n[WEAVING]\nShafts=oops\nTreadles=2\n'));
  await until(page, (n) => window.imbibe.counters.errors > n, errors);
  const problem = await page.evaluate(() => window.imbibe.counters.problems.find((p) => p.line > 0));
  assert.equal(problem.file, 'bad.wif');
  assert.match(await page.textContent('#toasts'), /bad\.wif:\d+:/);
  const good = '[WIF]\nVersion=1.1\n[CONTENTS]\nWEAVING=1\nWARP=1\nWEFT=1\nTHREADING=1\nTIEUP=1\nTREADLING=1\n[WEAVING]\nShafts=2\nTreadles=2\nRising Shed=true\n' +
    '[WARP]\nThreads=4\n[WEFT]\nThreads=4\n[THREADING]\n1=1\n2=1\n3=2\n4=2\n[TIEUP]\n1=1\n2=2\n[TREADLING]\n1=1\n2=1\n3=2\n4=2\n';
  await page.evaluate((text) => window.imbibe.openText('basket.wif', text), good);
  await until(page, () => document.querySelector('#title').textContent === 'basket.wif' || window.imbibe.counters.problems.some((p) => p.file === 'basket.wif'));
  assert.equal(await page.textContent('#title'), 'basket.wif', JSON.stringify(await page.evaluate(() => window.imbibe.counters.problems)));
});

test('a scene from the page may not name files of the server', async () => {
  const text = readFileSync(join(root, small), 'utf8').replace('    size:', '    weave: /etc/secret.wif\n    size:');
  const errors = await page.evaluate(() => window.imbibe.counters.errors);
  await page.evaluate((t) => window.imbibe.openText('evil.yaml', t), text);
  await until(page, (n) => window.imbibe.counters.errors > n, errors);
  assert.match(await page.evaluate(() => window.imbibe.counters.problems[0].message), /may not name files/);
});

test('1000 malformed messages are survived', async () => {
  const errors = await page.evaluate(() => window.imbibe.counters.errors);
  await page.evaluate(() => {
    const rubbish = ['', '{', '[]', '{}', '{"type":7}', '{"type":"set"}', '{"type":"set","assign":[1]}', '{"type":"drop","at":[1e999,0,0]}',
      '{"type":"' + 'x'.repeat(5000) + '"}', '['.repeat(2000), '{"type":"seek","time":"now"}', '\u0000', '{"type":"open","gallery":"../../etc/passwd"}'];
    for (let i = 0; i < 1000; ++i) window.imbibe.sendRaw(rubbish[i % rubbish.length]);
  });
  await until(page, (n) => window.imbibe.counters.errors >= n + 1000, errors);
  const steps = await value(page, 'steps');
  await send(page, { type: 'step', swatch: 0 });
  await reaches(page, 'steps', steps + 1);
});

test('two viewers watch, one holds the controls and may hand them over', async () => {
  const second = await openPage(browser, server.url, { width: 800, height: 600 });
  assert.equal(await second.evaluate(() => window.imbibe.holder === window.imbibe.hello.viewer), false);
  await send(second, { type: 'reset', swatch: 0 });
  await until(second, () => window.imbibe.counters.errors > 0);
  assert.match(await second.evaluate(() => window.imbibe.counters.problems[0].message), /controls/);
  await send(second, { type: 'take' });
  await until(second, () => window.imbibe.holder === window.imbibe.hello.viewer);
  await until(page, () => window.imbibe.holder !== window.imbibe.hello.viewer);
  const frames = await page.evaluate(() => window.imbibe.counters.frames);
  await send(second, { type: 'step', swatch: 0, steps: 5 });
  await until(page, (n) => window.imbibe.counters.frames > n, frames);
  assert.deepEqual(second.problems, []);
  await second.close();
  await until(page, () => window.imbibe.holder === window.imbibe.hello.viewer);
});

test('two swatches are compared: same drops, neither runs ahead', async () => {
  await page.evaluate(() => window.imbibe.send({ type: 'compare', on: true, assign: ['textiles[0].contact_angle=80 deg'] }));
  await until(page, () => window.imbibe.swatches.length === 2 && window.imbibe.swatches[1].frames > 0);
  await reaches(page, 'time_s', 0.01, 0);
  await reaches(page, 'time_s', 0.01, 1);
  await page.evaluate(() => window.imbibe.send({ type: 'pause', swatch: 255 }));
  await paused(page);
  assert.equal(await value(page, 'supplied_kg', 0), await value(page, 'supplied_kg', 1));
  assert.match(await page.textContent('#labels'), /left:.*right:/s);
  await send(page, { type: 'compare', on: false });
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

test('what was done live runs again offline to the same bits', async () => {
  await send(page, { type: 'run', swatch: 0 });
  await reaches(page, 'time_s', 0.006);
  await set(page, 'textiles[0].contact_angle=75 deg', 'air.humidity=30 %');
  await send(page, { type: 'drop', swatch: 0, at: [-3e-3, 1e-3, 0.3e-3], volume: 0.6e-9, speed: 0.1 });
  await reaches(page, 'time_s', 0.02);
  await set(page, 'gravity=[2 m/s2, 0 m/s2, -9.81 m/s2]', 'liquid.kind.surface_tension=40 mN/m');
  await reaches(page, 'time_s', 0.03);
  await server.stop();
  const folder = join(server.folder, 'run'), again = join(server.folder, 'again');
  execFileSync(command, ['run', join(folder, 'scene.yaml'), '--changes', join(folder, 'changes.jsonl'), '-o', again, '--no-pictures', '--threads', '1'],
    { env: { ...process.env, IMBIBE_DATA_DIR: root }, stdio: 'pipe' });
  const read = (f) => JSON.parse(readFileSync(join(f, 'run.json'), 'utf8'));
  assert.equal(read(again).steps, read(folder).steps);
  assert.equal(read(again).state_hash, read(folder).state_hash);
  assert.ok(readFileSync(join(folder, 'changes.jsonl'), 'utf8').split('\n').length >= 5);
});

test('a finished run is replayed: play, pause, any time', async () => {
  const again = join(server.folder, 'again');
  const replay = await startLive(again, '--speed', '0');
  try {
    const p = await openPage(browser, replay.url);
    await reaches(p, 'time_s', 0.029);
    await send(p, { type: 'pause' });
    await send(p, { type: 'seek', time: 0.011 });
    await until(p, () => Math.abs(window.imbibe.swatches[0].value('time_s') - 0.010) < 1e-9);
    assert.ok(await p.isVisible('#seek'));
    assert.ok(!(await p.isVisible('#panel')));
    assert.deepEqual(p.problems, []);
    await p.close();
  } finally {
    await replay.remove();
  }
});

function ask(port, text) {
  return new Promise((done) => {
    let reply = '';
    const socket = connect(port, '127.0.0.1', () => socket.write(text));
    socket.on('data', (data) => { reply += data.toString('latin1'); });
    socket.on('close', () => done(reply));
    socket.on('error', () => done(reply));
    setTimeout(() => socket.destroy(), 5000).unref();
  });
}

test('only pages of this server may use it, and only with the token where one is needed', async () => {
  const guarded = await startLive(small, '--listen', '0.0.0.0', '--token', 'letmein');
  try {
    const { port } = guarded;
    const upgrade = (path, host = `127.0.0.1:${port}`, origin = '') =>
      `GET ${path} HTTP/1.1\r\nHost: ${host}\r\n${origin ? `Origin: ${origin}\r\n` : ''}Upgrade: websocket\r\nConnection: Upgrade\r\n` +
      'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n';
    assert.match(await ask(port, upgrade('/live')), /^HTTP\/1\.1 403/);
    assert.match(await ask(port, upgrade('/live?token=wrong')), /^HTTP\/1\.1 403/);
    assert.match(await ask(port, upgrade('/live?token=letmein', `127.0.0.1:${port}`, 'http://evil.example')), /^HTTP\/1\.1 403/);
    assert.match(await ask(port, upgrade('/live?token=letmein')), /^HTTP\/1\.1 101[^]*s3pPLMBiTxaQ9kYGzzhZRbK\+xOo=/);
    const get = (path, method = 'GET') => ask(port, `${method} ${path} HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n\r\n`);
    assert.match(await get('/'), /^HTTP\/1\.1 200/);
    assert.match(await get('/../../etc/passwd'), /^HTTP\/1\.1 404/);
    assert.match(await get('/%2e%2e/etc/passwd'), /^HTTP\/1\.1 404/);
    assert.match(await get('/', 'POST'), /^HTTP\/1\.1 405/);
    assert.match(await ask(port, 'nonsense\r\n\r\n'), /^HTTP\/1\.1 400/);
    assert.match(await ask(port, `GET /${'x'.repeat(9000)}`), /^HTTP\/1\.1 431/);
  } finally {
    await guarded.remove();
  }
  const own = await startLive(small);
  try {
    const reply = await ask(own.port, `GET / HTTP/1.1\r\nHost: evil.example:${own.port}\r\n\r\n`);
    assert.match(reply, /^HTTP\/1\.1 403/);
  } finally {
    await own.remove();
  }
});

test('twenty viewers all get frames', async () => {
  const busy = await startLive(small, '--speed', '0', '--run');
  try {
    const p = await openPage(browser, busy.url);
    const frames = await p.evaluate(() => new Promise((done) => {
      const counts = new Array(20).fill(0);
      for (let i = 0; i < 20; ++i) {
        const socket = new WebSocket(new URL('live', location.href.replace(/^http/, 'ws')));
        socket.binaryType = 'arraybuffer';
        socket.onmessage = (e) => {
          if (typeof e.data !== 'string') ++counts[i];
          if (counts.every((n) => n >= 5)) done(counts);
        };
      }
    }));
    assert.equal(frames.length, 20);
    await p.close();
  } finally {
    await busy.remove();
  }
});

test('the page wrote no error to the console', () => {
  // A server that goes away is told by the browser itself.
  assert.deepEqual(page.problems.filter((text) => !/ERR_CONNECTION_REFUSED|WebSocket connection/.test(text)), []);
});
