// Films the live page for the README: node viewer/tools/film.mjs [OUT.gif]   (needs chromium and ffmpeg)
// A drop soaks into cotton; the contact angle is raised while it spreads; another drop falls by a click.
// IMBIBE_FILM_QUALITY=plain for machines without a graphics card.
import { execFileSync } from 'node:child_process';
import { mkdtempSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { openBrowser, openPage, root, startLive, until } from '../test/browser.mjs';

const out = resolve(process.argv[2] ?? join(root, 'docs/images/live.gif'));
const folder = mkdtempSync(join(tmpdir(), 'imbibe_film_'));
const server = await startLive('scenes/quickstart/drop_on_cotton.yaml', '--speed', '0');
const browser = await openBrowser();
const page = await openPage(browser, server.url, { width: 1280, height: 720, query: 'quality=plain&theme=light' });
await page.selectOption('#quality', process.env.IMBIBE_FILM_QUALITY ?? 'fine');
await page.fill('#filter', 'contact angle');
await page.evaluate(() => { document.querySelector('#look').value = 'bar'; window.imbibe.view.zoom(0.62); });

let frame = 0;
async function shoot(times = 1) {
  for (let draws = -1, now = 0; draws !== now; ) {  // until nothing is left to draw
    draws = now;
    await page.waitForTimeout(250);
    now = await page.evaluate(() => window.imbibe.view.draws);
  }
  const file = join(folder, `frame_${String(frame).padStart(4, '0')}.png`);
  await page.screenshot({ path: file, timeout: 120000 });
  for (let i = 0; i < times; ++i, ++frame)
    if (i > 0) execFileSync('cp', [file, join(folder, `frame_${String(frame).padStart(4, '0')}.png`)]);
}
async function steps(count) {
  const before = await page.evaluate(() => window.imbibe.swatches[0].value('steps'));
  await page.evaluate((n) => window.imbibe.send({ type: 'step', steps: n }), count);
  await until(page, (n) => window.imbibe.swatches[0].value('steps') >= n, before + count, 300000);
}
async function play(shots, each) { for (let i = 0; i < shots; ++i) { await steps(each); await shoot(); } }

await shoot(3);
await play(12, 25);
const input = page.locator('[data-path="textiles[0].contact_angle"] input');
await input.fill('115');
await input.press('Enter');
await until(page, () => window.imbibe.counters.changes > 0);
await play(10, 25);
await page.click('#mode-drop');
await page.fill('#drop-volume', '15');
const box = await page.locator('#canvas').boundingBox();
const at = await page.evaluate(() => window.imbibe.screen([8e-3, -5e-3, 0.2e-3]));
await page.mouse.click(box.x + at.x, box.y + at.y);
await until(page, () => window.imbibe.counters.changes > 1);
await play(12, 30);
await shoot(4);
await browser.close();
await server.remove();
execFileSync('ffmpeg', ['-y', '-loglevel', 'error', '-framerate', '8', '-i', join(folder, 'frame_%04d.png'), '-vf',
  'scale=960:-1:flags=lanczos,split[a][b];[a]palettegen=max_colors=128[p];[b][p]paletteuse=dither=bayer:bayer_scale=4', out]);
console.log(`${out}: ${frame} frames`);
