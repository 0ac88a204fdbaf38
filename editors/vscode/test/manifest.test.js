"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const path = require("node:path");
const { test } = require("node:test");

const ROOT = path.join(__dirname, "..");
const manifest = JSON.parse(fs.readFileSync(path.join(ROOT, "package.json"), "utf8"));
const code = fs.readFileSync(path.join(ROOT, "extension.js"), "utf8");

test("every file that the manifest names is there, and is JSON", () => {
  const { languages, grammars } = manifest.contributes;
  const files = [...languages.map((one) => one.configuration), ...grammars.map((one) => one.path)];
  assert.equal(files.length, 4);
  for (const file of files) {
    JSON.parse(fs.readFileSync(path.join(ROOT, file), "utf8"));
  }
});

test("the patterns of the language configurations are regular expressions", () => {
  for (const { configuration } of manifest.contributes.languages) {
    const { wordPattern } = JSON.parse(fs.readFileSync(path.join(ROOT, configuration), "utf8"));
    const word = (text) => text.match(new RegExp(wordPattern, "u"))[0];
    const name = configuration.includes("turtle") ? "ex:Löffel.2" : "akita_black_bowl_1";
    assert.equal(word(name), name);
  }
});

test("the extension uses the settings and commands that the manifest declares, and no others", () => {
  const { configuration, commands } = manifest.contributes;
  const used = [...code.matchAll(/settings\.get\("(\w+)"\)/g)].map((one) => `onto.${one[1]}`);
  assert.deepEqual([...new Set(used)].sort(), Object.keys(configuration.properties).sort());
  const registered = [...code.matchAll(/registerCommand\("([\w.]+)"/g)].map((one) => one[1]);
  assert.deepEqual(registered, commands.map((one) => one.command));
});
