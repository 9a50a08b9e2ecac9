// The browser and the server that the tests drive: Debian's chromium by playwright-core, the built command.
import { chromium } from 'playwright-core';
import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

export const root = resolve(dirname(fileURLToPath(import.meta.url)), '..', '..');
export const command = process.env.IMBIBE_COMMAND ?? join(root, 'build', 'release', 'imbibe');

// ms that a condition may take to come true: a loaded machine is slow, a fault never comes true.
export const patience = 180000;

export async function openBrowser() {
  const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find((p) => existsSync(p));
  if (!executablePath) throw new Error('no chromium: apt-get install chromium');
  return chromium.launch({ executablePath, timeout: patience, args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader', '--disable-dev-shm-usage', '--disable-background-timer-throttling',
    '--disable-renderer-backgrounding', '--disable-backgrounding-occluded-windows'] });
}

// Starts `imbibe live` and gives its address once it is printed.
export async function startLive(scene, ...options) {
  const folder = await mkdtemp(join(tmpdir(), 'imbibe_live_'));
  const child = spawn(command, ['live', resolve(root, scene), '--no-browser', '-o', join(folder, 'run'), ...options],
    { cwd: folder, env: { ...process.env, IMBIBE_DATA_DIR: root } });
  let output = '';
  const url = await new Promise((done, fail) => {
    const take = (data) => {
      output += data;
      const found = output.match(/http:\/\/\S+/);
      if (found) done(found[0]);
    };
    child.stdout.on('data', take);
    child.stderr.on('data', take);
    child.on('exit', (code) => fail(new Error(`imbibe live ended with ${code}:\n${output}`)));
    setTimeout(() => fail(new Error(`imbibe live printed no address:\n${output}`)), patience).unref();
  });
  const ended = new Promise((done) => child.on('exit', done));
  return {
    url, folder, child, output: () => output,
    port: Number(new URL(url).port),
    async stop() { child.kill('SIGTERM'); await ended; return output; },
    async remove() { await this.stop(); await rm(folder, { recursive: true, force: true }); },
  };
}

// A page with its console errors collected.
export async function openPage(browser, url, { width = 1280, height = 720, query = 'quality=plain&theme=light' } = {}) {
  const page = await browser.newPage({ viewport: { width, height } });
  page.setDefaultTimeout(patience);
  page.problems = [];
  page.on('console', (m) => { if (m.type() === 'error') page.problems.push(m.text()); });
  page.on('pageerror', (e) => page.problems.push(String(e)));
  await page.goto(url + (url.includes('?') ? '&' : '?') + query);
  await until(page, () => window.imbibe?.counters.frames > 0);
  return page;
}

// Asks the page until `test` holds there. (waitForFunction would want the page to allow eval(), which it does not.)
export async function until(page, test, argument, timeout = patience) {
  const end = Date.now() + timeout;
  for (;;) {
    const value = await page.evaluate(test, argument);
    if (value) return value;
    if (Date.now() > end) throw new Error(`the page never came to: ${test} with ${JSON.stringify(argument)}`);
    await new Promise((done) => setTimeout(done, 50));
  }
}

// Sends a message and waits until the simulation has carried it out: at which step, at what time.
export const ask = (page, message) => page.evaluate((m) => window.imbibe.ask(m), message);
