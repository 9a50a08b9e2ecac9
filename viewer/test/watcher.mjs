// A viewer without a browser: a WebSocket client that counts what the server sends (RFC 6455; a server's frames are not
// masked). For the load tests and measures, where twenty browsers would measure the browsers.
import { randomBytes } from 'node:crypto';
import { readdirSync, readFileSync } from 'node:fs';
import { connect } from 'node:net';
import { patience } from './browser.mjs';

export class Watcher {
  frames = 0;
  bytes = 0;
  largest = 0;
  longest = 0;    // ms between two frames
  ended = false;  // the newest frame says so
  values = null;  // of the newest frame
  texts = new Map();
  done = null;    // the newest answer to an ask
  columns = [];
  first = 0;      // performance.now() of the first frame
  #last = 0;
  #parts = [];
  #size = 0;
  #waiting = [];

  static open(url) {
    const { hostname, port, search } = new URL(url);
    const watcher = new Watcher();
    const socket = connect(Number(port), hostname);
    socket.write(`GET /live${search} HTTP/1.1\r\nHost: ${hostname}:${port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n` +
      `Sec-WebSocket-Key: ${randomBytes(16).toString('base64')}\r\nSec-WebSocket-Version: 13\r\n\r\n`);
    watcher.socket = socket;
    return new Promise((done, fail) => {
      let head = Buffer.alloc(0);
      const handshake = (data) => {
        head = Buffer.concat([head, data]);
        const end = head.indexOf('\r\n\r\n');
        if (end < 0) return;
        if (!head.subarray(0, 12).equals(Buffer.from('HTTP/1.1 101'))) return fail(new Error(head.subarray(0, end).toString()));
        socket.off('data', handshake);
        socket.on('data', (more) => watcher.#take(more));
        watcher.#take(head.subarray(end + 4));
        done(watcher);
      };
      socket.on('data', handshake);
      socket.on('error', fail);
    });
  }

  count(type) { return this.texts.get(type) ?? 0; }
  value(name) { return this.values?.[this.columns.indexOf(name)] ?? 0; }

  send(message) {
    const payload = Buffer.from(typeof message === 'string' ? message : JSON.stringify(message)), n = payload.length;
    const mask = randomBytes(4);
    for (let i = 0; i < n; ++i) payload[i] ^= mask[i & 3];
    const head = n < 126 ? [0x81, 0x80 | n] : n < 65536 ? [0x81, 0x80 | 126, n >> 8, n & 255] : [0x81, 0x80 | 127, 0, 0, 0, 0, n >>> 24, (n >> 16) & 255, (n >> 8) & 255, n & 255];
    this.socket.write(Buffer.concat([Buffer.from(head), mask, payload]));
  }

  until(test) {
    return new Promise((done, fail) => {
      if (test()) return done();
      const timer = setTimeout(() => fail(new Error(`a viewer never came to: ${test}`)), patience);
      this.#waiting.push(() => test() && (clearTimeout(timer), done(), true));
    });
  }

  close() { this.socket.destroy(); }

  #take(data) {
    this.#parts.push(data);
    this.#size += data.length;
    for (;;) {
      const bytes = this.#parts.length > 1 ? Buffer.concat(this.#parts) : this.#parts[0];
      this.#parts = [bytes];
      if (bytes.length < 2) return;
      let length = bytes[1] & 127, from = 2;
      if (length === 126) { if (bytes.length < 4) return; length = bytes.readUInt16BE(2); from = 4; }
      else if (length === 127) { if (bytes.length < 10) return; length = Number(bytes.readBigUInt64BE(2)); from = 10; }
      if (bytes.length < from + length) return;
      const payload = bytes.subarray(from, from + length);
      this.#parts = [bytes.subarray(from + length)];
      if ((bytes[0] & 15) === 1) this.#text(JSON.parse(payload));
      else if ((bytes[0] & 15) === 2) this.#frame(payload);
      this.#waiting = this.#waiting.filter((met) => !met());
    }
  }

  #text(message) {
    this.texts.set(message.type, this.count(message.type) + 1);
    if (message.type === 'hello') this.columns = message.columns;
    if (message.type === 'done') this.done = message;
  }

  #frame(payload) {
    if (payload[7] === 1) return;  // geometry
    const now = performance.now();
    if (this.frames === 0) this.first = now; else this.longest = Math.max(this.longest, now - this.#last);
    this.#last = now;
    ++this.frames;
    this.ended = (payload.readUInt16LE(16) & 2) !== 0;
    this.bytes += payload.length;
    this.largest = Math.max(this.largest, payload.length);
    this.values = Array.from({ length: payload.readUInt32LE(20) }, (_, i) => payload.readDoubleLE(24 + 8 * i));
  }
}

// Processor time so far, s: of the server (the process's first thread) and of all others, which simulate.
export function processorSeconds(pid) {
  let server = 0, others = 0;
  for (const tid of readdirSync(`/proc/${pid}/task`)) {
    try {
      const [run] = readFileSync(`/proc/${pid}/task/${tid}/schedstat`, 'utf8').split(' ');  // ns
      if (Number(tid) === pid) server += 1e-9 * Number(run); else others += 1e-9 * Number(run);
    } catch { /* a thread that has ended */ }
  }
  return { server, others };
}
