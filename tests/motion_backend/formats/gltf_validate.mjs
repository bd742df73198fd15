// Validates the GLB files named on the command line with the Khronos validator; prints one JSON report a file.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(new URL("../../gltf/package.json", import.meta.url));
const validator = require("gltf-validator");

for (const path of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(path)), { maxIssues: 50 });
  console.log(JSON.stringify({ path, issues: report.issues, info: report.info }));
}
