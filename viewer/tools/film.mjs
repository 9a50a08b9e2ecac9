// Films the live page for the README: node viewer/tools/film.mjs [OUT.webp]   (needs chromium and ffmpeg)
// On a small piece of the quickstart's cotton: a drop lies on cotton that it does not wet (95 degrees); the contact angle is pulled down to 30 while it lies there, and
// it soaks in; another drop falls by a click. Writes OUT and, beside it, a still (OUT with .png).
// IMBIBE_FILM_QUALITY=plain where no graphics card is there and time is short.
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdtempSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { ask, openBrowser, openPage, root, startLive, until } from '../test/browser.mjs';

const out = resolve(process.argv[2] ?? join(root, 'docs/images/live.webp'));
const folder = mkdtempSync(join(tmpdir(), 'imbibe_film_'));
const server = await startLive('scenes/quickstart/drop_on_cotton.yaml', '--speed', '0', '--set', 'textiles[0].contact_angle=95 deg',
  '--set', 'textiles[0].size=[22 mm, 22 mm]', '--set', 'liquid.drops[0].volume=25 uL', '--set', 'liquid.drops[0].centre=[-2 mm, 1 mm, 2.2 mm]');
const browser = await openBrowser();
const page = await openPage(browser, server.url, { width: 1120, height: 660, query: 'quality=plain&theme=light' });
await page.evaluate((quality) => {
  const { view } = window.imbibe, choice = document.querySelector('#quality');
  view.hold = true;
  choice.value = quality;
  choice.onchange({ target: choice });
}, process.env.IMBIBE_FILM_QUALITY ?? 'fine');
await page.fill('#filter', 'contact angle');

let frame = 0;
const file = (i) => join(folder, `frame_${String(i).padStart(4, '0')}.png`);
async function shoot(times = 1) {
  await page.evaluate(() => { window.imbibe.curves.update(true); window.imbibe.view.drawNow(); });
  await page.screenshot({ path: file(frame) });
  for (let i = 1; i < times; ++i) copyFileSync(file(frame), file(frame + i));
  frame += times;
}
async function runTo(time) {
  while ((await page.evaluate(() => window.imbibe.swatches[0].value('time_s'))) < time) {
    const { step } = await ask(page, { type: 'step', swatch: 0, steps: 40 });
    await until(page, (n) => window.imbibe.swatches[0].value('steps') >= n, step + 40);
  }
}
async function play(shots, from, to) {
  for (let i = 1; i <= shots; ++i) { await runTo(from + ((to - from) * i) / shots); await shoot(); }
}

await shoot(2);
await play(7, 0, 0.042);
const input = page.locator('[data-path="textiles[0].contact_angle"] input');
await input.fill('30');
await input.press('Enter');
await until(page, () => window.imbibe.counters.changes > 0);
await shoot(3);
await play(8, 0.042, 0.2);
await page.click('#mode-drop');
await page.fill('#drop-volume', '8');
const box = await page.locator('#canvas').boundingBox();
const at = await page.evaluate(() => window.imbibe.screen([5.5e-3, -4.5e-3, 0.2e-3]));
await page.mouse.click(box.x + at.x, box.y + at.y);
await until(page, () => window.imbibe.counters.changes > 1);
await play(8, 0.2, 0.3);
await shoot(6);
await browser.close();
await server.remove();
const still = out.replace(/\.\w+$/, '.png');
execFileSync('ffmpeg', ['-y', '-loglevel', 'error', '-i', file(frame - 9), '-vf', 'split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=bayer:bayer_scale=5', still]);
// As good as fits into the README.
for (const quality of [70, 55, 40, 30, 20]) {
  execFileSync('ffmpeg', ['-y', '-loglevel', 'error', '-framerate', '5', '-i', join(folder, 'frame_%04d.png'), '-vf', 'scale=840:-1:flags=lanczos',
    '-c:v', 'libwebp_anim', '-quality', String(quality), '-compression_level', '6', '-loop', '0', out]);
  if (statSync(out).size <= 300e3) break;
}
rmSync(folder, { recursive: true });
console.log(`${out}: ${frame} frames, ${(statSync(out).size / 1e3).toFixed(0)} kB; ${still}: ${(statSync(still).size / 1e3).toFixed(0)} kB`);
