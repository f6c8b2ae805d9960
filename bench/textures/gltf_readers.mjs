// SPDX-License-Identifier: GPL-3.0-or-later

// Reads glTF files by the packages gltf-validator and @gltf-transform, and prints what they say of
// each as JSON.
//
// Usage: node bench/textures/gltf_readers.mjs MODULES FILE...      (MODULES: a node_modules)

import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const [modules, ...files] = process.argv.slice(2);
const require = createRequire(join(resolve(modules), '..', 'package.json'));
const load = (name) => import(pathToFileURL(require.resolve(name)).href);

const validator = require('gltf-validator');
const { NodeIO, Logger } = await load('@gltf-transform/core');
const { ALL_EXTENSIONS } = await load('@gltf-transform/extensions');
const { inspect } = await load('@gltf-transform/functions');
const draco = await load('draco3dgltf').then((found) => (found.default ?? found).createDecoderModule(), () => undefined);
const io = new NodeIO()
  .setLogger(new Logger(Logger.Verbosity.SILENT))
  .registerExtensions(ALL_EXTENSIONS)
  .registerDependencies(draco ? { 'draco3d.decoder': draco } : {});

async function validated(file) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: file,
    maxIssues: 0,
    externalResourceFunction: async (uri) => new Uint8Array(await readFile(join(dirname(file), decodeURIComponent(uri)))),
  });
  const { numErrors, numWarnings, messages } = report.issues;
  return { errors: numErrors, warnings: numWarnings, messages: messages.filter((one) => one.severity < 2).map((one) => `${one.code}: ${one.message} (${one.pointer})`) };
}

async function transformed(file) {
  const document = await io.read(file);
  const { textures } = inspect(document);
  return textures.properties.map((one) => ({ mimeType: one.mimeType, slots: one.slots, resolution: one.resolution, gpuSize: one.gpuSize }));
}

const found = [];
for (const file of files) {
  const said = { file, validator: await validated(file) };
  try {
    said.textures = await transformed(file);
  } catch (error) {
    said.refused = String(error.message ?? error);
  }
  found.push(said);
}
const version = (name) => require(join(resolve(modules), name, 'package.json')).version;
console.log(JSON.stringify({ versions: { 'gltf-validator': validator.version(), 'gltf-transform': version('@gltf-transform/core') }, found }));
