import { defineConfig } from 'vite';

// One script, one style sheet, one page: the server hands out exactly these files. No source maps, no foreign address.
export default defineConfig({
  base: './',
  build: { outDir: 'dist', target: 'es2022', chunkSizeWarningLimit: 1200, modulePreload: false, assetsInlineLimit: 0 },
});
