// SPDX-License-Identifier: GPL-3.0-or-later

// Prints the errors of a glTF file as JSON, as the npm package gltf-validator finds them; NODE_PATH has it.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";

const { validateBytes } = createRequire(import.meta.url)("gltf-validator");
const path = process.argv[2];
const report = await validateBytes(new Uint8Array(await readFile(path)), {
  externalResourceFunction: async (uri) =>
    new Uint8Array(await readFile(join(dirname(path), decodeURIComponent(uri)))),
});
const errors = report.issues.messages.filter((message) => message.severity === 0);
console.log(JSON.stringify(errors.map(({ code, pointer }) => `${code} at ${pointer}`)));
