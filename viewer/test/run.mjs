// Runs the page's tests, or says what is missing for them (exit code 77: left out).
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url)), viewer = dirname(here);
const missing = [];
if (!existsSync(join(viewer, 'dist', 'index.html'))) missing.push('the built page (npm install && npm run build in viewer/)');
if (!existsSync(join(viewer, 'node_modules', 'playwright-core'))) missing.push('playwright-core (npm ci in viewer/)');
if (!['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].some(existsSync)) missing.push('chromium');
if (missing.length > 0) {
  console.log(`left out; missing: ${missing.join(', ')}`);
  process.exit(77);
}
process.exit(spawnSync(process.execPath, ['--test', ...process.argv.slice(2), join(here, 'live.test.mjs')], { stdio: 'inherit' }).status ?? 1);
