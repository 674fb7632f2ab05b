import { defineConfig } from "vite";

// Relative addresses, so that the page also works behind a proxy that puts the service under a prefix.
export default defineConfig({
  base: "./",
  build: { target: "es2022", chunkSizeWarningLimit: 2500, assetsInlineLimit: 0 },
  // The Host header stays the browser's: the service serves the page whose origin that is, and no other.
  server: { proxy: { "^/(api|health)/": { target: "http://127.0.0.1:8000", changeOrigin: false } } },
});
