// Measures of the live page: node viewer/tools/measure.mjs [SCENE [VIEWERS [SECONDS [THREADS]]]]
// Size of the page, time to the first frame, bytes of frames, frames per second, processor time of the server per viewer,
// steps until a change is taken, and what many viewers cost the simulation: slices of 2 s with one viewer and with many,
// in turn, so that both see the same stretch of the run. Viewers without a browser (../test/watcher.mjs); the time until
// a browser's page has its first frame is taken last, where there is a browser.
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { openBrowser, openPage, root, startLive } from '../test/browser.mjs';
import { Watcher, processorSeconds } from '../test/watcher.mjs';

const scene = process.argv[2] ?? 'scenes/quickstart/drop_on_cotton.yaml', viewers = Number(process.argv[3] ?? 20);
const seconds = Number(process.argv[4] ?? 24), threads = process.argv[5] ?? '1';
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const mean = (x) => x.reduce((a, b) => a + b, 0) / Math.max(1, x.length);

const dist = join(root, 'viewer/dist');
const filesIn = (folder) => readdirSync(folder, { withFileTypes: true }).flatMap((f) => (f.isDirectory() ? filesIn(join(folder, f.name)) : [join(folder, f.name)]));
const gzipped = existsSync(dist) ? filesIn(dist).reduce((sum, f) => sum + gzipSync(readFileSync(f)).length, 0) : 0;
console.log(`${scene}, ${threads} threads, ${viewers} viewers`);
console.log(`page: ${(gzipped / 1e3).toFixed(0)} kB gzipped`);

const started = performance.now();
const server = await startLive(scene, '--speed', '0', '--run', '--threads', threads), pid = server.child.pid;
const address = performance.now() - started;
const first = await Watcher.open(server.url);
await first.until(() => first.frames > 0);
console.log(`first frame ${(performance.now() - started).toFixed(0)} ms after the start (address printed after ${address.toFixed(0)} ms)`);

const slices = { one: [], many: [] };
let others = [];
for (const end = performance.now() + 1000 * seconds, begun = performance.now(); performance.now() < end;) {
  const many = (slices.one.length + slices.many.length) % 2 === 1;
  others = many ? await Promise.all(Array.from({ length: viewers - 1 }, () => Watcher.open(server.url))) : [];
  await Promise.all(others.map((w) => w.until(() => w.frames > 0)));
  const all = [first, ...others], steps = first.value('steps'), frames = all.map((w) => w.frames), cpu = processorSeconds(pid), at = performance.now();
  await wait(2000);
  const now = processorSeconds(pid), s = (performance.now() - at) / 1000, made = first.value('steps') - steps;
  const sent = all.map((w, i) => w.frames - frames[i]);
  others.forEach((w) => w.close());
  if (first.ended) break;  // the slice would count time in which nothing moves
  slices[many ? 'many' : 'one'].push({ rate: made / s, each: (now.others - cpu.others) / made, server: (now.server - cpu.server) / s,
    frame: (now.server - cpu.server) / sent.reduce((a, b) => a + b, 0), fps: mean(sent) / s, at: first.value('time_s'), time: (performance.now() - begun) / 1000 });
}
for (const [name, list] of Object.entries(slices)) {
  const of = (key) => mean(list.map((x) => x[key]));
  console.log(`${name === 'one' ? '1 viewer ' : `${viewers} viewers`}: ${of('rate').toFixed(1)} steps/s, ${(1e3 * of('each')).toFixed(3)} ms of processor time a step; ` +
    `${of('fps').toFixed(1)} frames/s to each; server ${(100 * of('server')).toFixed(2)} % of a core, ${(1e6 * of('frame')).toFixed(0)} us a frame = ` +
    `${(100 * 30 * of('frame')).toFixed(2)} % of a core per viewer at 30 Hz`);
}
const slowest = [...slices.one, ...slices.many].reduce((a, b) => (b.fps < a.fps ? b : a));
console.log(`least frames/s in 2 s: ${slowest.fps.toFixed(1)} after ${slowest.time.toFixed(0)} s, at ${slowest.at.toFixed(2)} s of ${first.value('time_s').toFixed(2)} s simulated ` +
  `(${slowest.rate.toFixed(0)} steps/s, ${(1e3 * slowest.each).toFixed(1)} ms of processor time a step); longest time without a frame ${first.longest.toFixed(0)} ms`);
// Neighbouring slices: what the run does meanwhile cancels out.
const pairs = slices.many.map((m, i) => [slices.one[i], m, slices.one[i + 1]]).filter((p) => p[2]);
const slower = (key) => 100 * mean(pairs.map(([a, m, b]) => (2 * m[key]) / (a[key] + b[key]) - 1));
if (pairs.length > 0)
  console.log(`with ${viewers} viewers: steps per second ${slower('rate').toFixed(1)} %, processor time of a step ${slower('each') > 0 ? '+' : ''}${slower('each').toFixed(1)} %`);
console.log(`frames: ${(first.bytes / first.frames / 1e3).toFixed(1)} kB on average, ${(first.largest / 1e3).toFixed(1)} kB the largest`);

// A slider: from its message to the simulation that takes it, in steps of that time.
const took = [], steps = [];
for (let i = 1; i <= 20; ++i) {
  const sent = performance.now();
  first.send({ type: 'set', assign: [`air.humidity=${40 + i} %`], ask: i });
  await first.until(() => first.count('done') >= i);
  took.push(performance.now() - sent);
  steps.push(first.done.step - first.done.arrived + 1);  // the step under way when it came, and the one that it changes
}
console.log(`a change is in the physics ${mean(steps).toFixed(1)} steps after it came (at most ${Math.max(...steps)}); its answer takes ${mean(took).toFixed(0)} ms`);

// One that is dragged: twenty values a second, as the page sends them; what frames do meanwhile.
for (const [name, value] of [['air.humidity', (i) => `${40 + (i % 40)} %`], ['textiles[0].contact_angle', (i) => `${30 + (i % 40)} deg`]]) {
  const gaps = [], begun = performance.now(), from = first.frames, taken = first.count('changed'), made = first.value('steps');
  let last = begun, seen = first.frames;
  for (let i = 0; i < 60; ++i) {
    first.send({ type: 'set', assign: [`${name}=${value(i)}`] });
    for (const end = begun + 50 * (i + 1); performance.now() < end;) {
      await wait(1);
      if (first.frames > seen) gaps.push(performance.now() - last), last = performance.now(), seen = first.frames;
    }
  }
  const s = (performance.now() - begun) / 1000;
  console.log(`${name} dragged for ${s.toFixed(1)} s: ${first.count('changed') - taken} changes taken, ${((first.value('steps') - made) / s).toFixed(0)} steps/s, ` +
    `${((first.frames - from) / s).toFixed(1)} frames/s, longest time without one ${Math.max(...gaps).toFixed(0)} ms`);
}
first.close();
if (process.env.IMBIBE_MEASURE_PAGE) {
  const browser = await openBrowser(), asked = performance.now();
  await openPage(browser, server.url);
  console.log(`a browser's page has its first frame ${(performance.now() - asked).toFixed(0)} ms after it was asked for`);
  await browser.close();
}
await server.remove();
