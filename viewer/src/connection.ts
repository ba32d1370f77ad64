// SPDX-License-Identifier: Apache-2.0
// One WebSocket to the gateway, for ever: it says hello, reconnects with back-off when it is lost,
// and hands on decoded messages. Only a wrong token or protocol stops it, until `retry`.

import { backoff } from './backoff';
import { decodeMessage, kProtocol, type FromGateway, type ToGateway } from './protocol';
import { decodeRegion, type Region } from './region';
import { Signal } from './signal';

export type ConnectionState = 'connecting' | 'open' | 'lost' | 'denied';

const kPingMs = 5000;
const kSilenceMs = 20000;
const kPolicyViolation = 1008;

export class Connection {
  readonly state = new Signal<ConnectionState>();
  readonly message = new Signal<FromGateway>();
  readonly region = new Signal<Region>();
  /** A message from the gateway that does not decode; it changed nothing. */
  readonly problem = new Signal<string>();

  /** Why the connection is not open, for people. */
  reason = '';
  /** When the next attempt is due, by performance.now(), while lost. */
  nextAttempt = 0;

  private socket_: WebSocket | null = null;
  private current_: ConnectionState = 'connecting';
  private attempts_ = 0;
  private timer_ = 0;
  private heard_ = 0;

  constructor(private readonly address_: () => string) {
    window.setInterval(() => this.watch(), kPingMs);
    window.addEventListener('online', () => this.current_ === 'lost' && this.retry());
  }

  get current(): ConnectionState {
    return this.current_;
  }

  /** Connects now, whatever the back-off says. */
  retry(): void {
    window.clearTimeout(this.timer_);
    this.socket_?.close();
    this.open();
  }

  send(message: ToGateway): void {
    if (this.socket_?.readyState === WebSocket.OPEN) this.socket_.send(JSON.stringify(message));
  }

  private open(): void {
    this.become(this.attempts_ === 0 ? 'connecting' : this.current_ === 'denied' ? 'connecting' : this.current_);
    let socket: WebSocket;
    try {
      socket = new WebSocket(this.address_());
    } catch {
      this.deny('The address of the session is not valid');
      return;
    }
    socket.binaryType = 'arraybuffer';
    this.socket_ = socket;
    socket.onopen = () => this.opened(socket);
    socket.onmessage = (event) => socket === this.socket_ && this.take(event.data);
    socket.onclose = (event) => socket === this.socket_ && this.closed(event);
  }

  private opened(socket: WebSocket): void {
    if (socket !== this.socket_) return;
    this.heard_ = performance.now();
    this.reason = '';
    this.become('open');
    this.send({ type: 'hello', protocol: kProtocol });
  }

  private take(data: unknown): void {
    this.heard_ = performance.now();
    this.attempts_ = 0;
    if (typeof data === 'string') {
      const message = decodeMessage(data);
      if (message.ok) this.message.emit(message.value);
      else this.problem.emit(message.problem);
    } else if (data instanceof ArrayBuffer) {
      const region = decodeRegion(data);
      if (region.ok) this.region.emit(region.value);
      else this.problem.emit(region.problem);
    }
  }

  private closed(event: CloseEvent): void {
    this.socket_ = null;
    if (event.code === kPolicyViolation) {
      this.deny(event.reason || 'The server closed this page’s connection');
      return;
    }
    this.lost(event.reason);
    if (this.current_ === 'lost' && this.attempts_ === 1) void this.askWhy();
  }

  private lost(reason: string): void {
    this.reason = reason;
    const wait = backoff(++this.attempts_, Math.random());
    this.nextAttempt = performance.now() + wait;
    this.become('lost');
    this.timer_ = window.setTimeout(() => this.open(), wait);
  }

  /** A browser does not tell why a handshake failed; plain HTTP does. */
  private async askWhy(): Promise<void> {
    const url = new URL(this.address_());
    url.protocol = url.protocol === 'wss:' ? 'https:' : 'http:';
    try {
      const { status } = await fetch(url, { cache: 'no-store' });
      if ((status === 401 || status === 403) && this.current_ === 'lost') {
        this.deny('The access token is missing or wrong: the program prints the address with it when it starts');
      }
    } catch {
      // Not reachable at all: that is what the state says already.
    }
  }

  private deny(reason: string): void {
    window.clearTimeout(this.timer_);
    this.reason = reason;
    this.attempts_ = 0;
    this.become('denied');
  }

  /** Pings a quiet gateway and gives up one that has said nothing for long. */
  private watch(): void {
    if (this.current_ !== 'open') return;
    const quiet = performance.now() - this.heard_;
    if (quiet > kSilenceMs) {
      const socket = this.socket_;
      this.socket_ = null;
      socket?.close();
      this.lost('The server has fallen silent');
    } else if (quiet > kPingMs) {
      this.send({ type: 'ping', time: performance.now() });
    }
  }

  private become(state: ConnectionState): void {
    this.current_ = state;
    this.state.emit(state);
  }
}
