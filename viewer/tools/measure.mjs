// Measures of the live page: node viewer/tools/measure.mjs [SCENE] [VIEWERS]
// Time to the first frame, bytes of frames, processor time of the server's thread per viewer, steps of the simulation with one and
// with many viewers. Processor times, not wall times, so that other work on the machine counts little.
import { gzipSync } from 'node:zlib';
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { openBrowser, openPage, root, startLive, until } from '../test/browser.mjs';

const scene = process.argv[2] ?? 'scenes/quickstart/drop_on_cotton.yaml', viewers = Number(process.argv[3] ?? 20);
const dist = join(root, 'viewer/dist');
const files = readdirSync(dist, { recursive: true, withFileTypes: true }).filter((f) => f.isFile());
const gzipped = files.reduce((sum, f) => sum + gzipSync(readFileSync(join(f.parentPath ?? f.path, f.name))).length, 0);
console.log(`page: ${(gzipped / 1e3).toFixed(0)} kB gzipped`);

// Seconds of processor time of each thread of a process.
function cpu(pid) {
  const times = new Map();
  for (const tid of readdirSync(`/proc/${pid}/task`)) {
    const fields = readFileSync(`/proc/${pid}/task/${tid}/stat`, 'utf8').split(') ')[1].split(' ');
    times.set(Number(tid), (Number(fields[11]) + Number(fields[12])) / 100);
  }
  return times;
}

const started = Date.now();
const server = await startLive(scene, '--speed', '0', '--run', '--threads', '1');
const address = Date.now() - started;
const browser = await openBrowser();
const opened = Date.now();
const page = await openPage(browser, server.url);
console.log(`address printed after ${address} ms, first frame ${Date.now() - opened} ms after the page was asked for`);
const open = (n) => page.evaluate((count) => {
  window.others ??= [];
  for (let i = 0; i < count; ++i) {
    const other = { frames: 0, bytes: 0, largest: 0 };
    const socket = new WebSocket(new URL('live', location.href.replace(/^http/, 'ws')));
    socket.binaryType = 'arraybuffer';
    socket.onmessage = (e) => {
      if (typeof e.data === 'string' || new Uint8Array(e.data)[7] === 1) return;
      ++other.frames; other.bytes += e.data.byteLength; other.largest = Math.max(other.largest, e.data.byteLength);
    };
    window.others.push(other);
  }
}, n);
// For 8 s: processor time of the main thread (the server) and of all others (the simulation), steps and frames.
async function watch(label) {
  const pid = server.child.pid, a = cpu(pid), steps = await page.evaluate(() => window.imbibe.swatches[0].value('steps'));
  const frames = await page.evaluate(() => window.imbibe.counters.frames + (window.others ?? []).reduce((s, o) => s + o.frames, 0));
  await new Promise((done) => setTimeout(done, 8000));
  const b = cpu(pid), more = await page.evaluate(() => window.imbibe.swatches[0].value('steps')) - steps;
  const sent = await page.evaluate(() => window.imbibe.counters.frames + (window.others ?? []).reduce((s, o) => s + o.frames, 0)) - frames;
  let own = 0, others = 0;
  for (const [tid, t] of b) { const used = t - (a.get(tid) ?? 0); if (tid === pid) own += used; else others += used; }
  console.log(`${label}: ${more} steps in ${others.toFixed(2)} s of the simulation's processor time (${(1e3 * others / more).toFixed(2)} ms a step); ` +
    `server ${own.toFixed(2)} s for ${sent} frames, ${(1e6 * own / Math.max(sent, 1)).toFixed(0)} us a frame = ${(100 * 30 * own / Math.max(sent, 1)).toFixed(2)} % of a core at 30 Hz`);
}
await watch('1 viewer');
await open(viewers - 1);
await watch(`${viewers} viewers`);
const counters = await page.evaluate(() => window.imbibe.counters);
console.log(`frames: ${(counters.bytes / counters.frames / 1e3).toFixed(1)} kB on average, ${(counters.largest / 1e3).toFixed(1)} kB the largest`);
await browser.close();
await server.remove();
