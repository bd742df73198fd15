/** The page is built into the Python package; while developing, calls go to a service on this machine. */
import { defineConfig } from "vite";

const SERVICE = "http://127.0.0.1:8000";

export default defineConfig({
  base: "./",
  build: {
    outDir: "../planner_service/page",
    emptyOutDir: true,
    target: "es2022",
    // Files stay files: a page that may only load from its own origin needs no data: addresses.
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 800,
    // How long plug-ins took is no warning to who only serves the page.
    rolldownOptions: { checks: { bundlerTimings: false } },
  },
  server: { proxy: { "/v1": SERVICE, "/session": SERVICE, "/healthz": SERVICE, "/readyz": SERVICE } },
});
