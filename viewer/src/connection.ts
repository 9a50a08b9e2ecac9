// The WebSocket to the server: gives out messages and frames, and comes back by itself when the server was away.
import { decodeFrame, type ClientMessage, type Frame, type ServerMessage } from './protocol';

export interface Handlers {
  message(message: ServerMessage): void;
  frame(frame: Frame): void;
  state(connected: boolean): void;
}

export class Connection {
  private socket: WebSocket | null = null;
  private wait = 250;  // ms to the next try

  constructor(private readonly handlers: Handlers) { this.open(); }

  private open(): void {
    const token = new URLSearchParams(location.search).get('token');
    const address = new URL('live', location.href.replace(/^http/, 'ws'));
    address.search = token ? `?token=${encodeURIComponent(token)}` : '';
    address.hash = '';
    const socket = new WebSocket(address);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.onopen = () => { this.wait = 250; this.handlers.state(true); };
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      if (typeof event.data === 'string') this.handlers.message(JSON.parse(event.data) as ServerMessage);
      else this.handlers.frame(decodeFrame(event.data));
    };
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.handlers.state(false);
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(2 * this.wait, 2000);
    };
  }

  send(message: ClientMessage): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  sendRaw(text: string): void { this.socket?.send(text); }
}
