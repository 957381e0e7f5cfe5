// Validates glTF files with Khronos's validator and prints one line of JSON for each.
//
//     NODE_PATH=FOLDER/node_modules node tests/tools/validate_gltf.js FILE...
const { readFileSync } = require("fs");
const { validateBytes } = require("gltf-validator");

(async () => {
  for (const file of process.argv.slice(2)) {
    const { issues, info } = await validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 10 });
    const { numErrors: errors, numWarnings: warnings, messages } = issues;
    console.log(JSON.stringify({ file, errors, warnings, messages, triangles: info.totalTriangleCount }));
  }
})();
