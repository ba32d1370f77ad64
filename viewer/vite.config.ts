// SPDX-License-Identifier: Apache-2.0
// Build, tests and the development server, which brings its own mock gateway.

import type { Plugin } from 'vite';
import { defineConfig } from 'vitest/config';
import { attachMock } from './mock/gateway';

const kPolicy = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
  + "connect-src 'self' ws: wss:; base-uri 'none'; form-action 'none'";

/** The built page may load nothing but itself; the development server's inline styles need more. */
const contentPolicy: Plugin = {
  name: 'content-policy',
  apply: 'build',
  transformIndexHtml: () => [{
    tag: 'meta', injectTo: 'head-prepend', attrs: { 'http-equiv': 'Content-Security-Policy', content: kPolicy },
  }],
};

const mockGateway: Plugin = {
  name: 'mock-gateway',
  apply: 'serve',
  configureServer: (server) => { if (server.httpServer) attachMock(server.httpServer); },
};

export default defineConfig({
  base: './',
  plugins: [contentPolicy, mockGateway],
  server: { host: '127.0.0.1', port: 5173 },
  build: { target: 'es2022', assetsInlineLimit: 0, modulePreload: { polyfill: false } },
  test: { globals: true, include: ['../tests/viewer/**/*.test.ts'], environment: 'node', testTimeout: 10000 },
});
