"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const path = require("node:path");
const { before, test } = require("node:test");
const oniguruma = require("vscode-oniguruma");
const { INITIAL, Registry, parseRawGrammar } = require("vscode-textmate");

const SYNTAXES = path.join(__dirname, "..", "syntaxes");
const grammars = {};

before(async () => {
  const wasm = fs.readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm"));
  await oniguruma.loadWASM(wasm.buffer);
  const registry = new Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async (scope) => {
      const file = path.join(SYNTAXES, `${scope.replace("source.", "")}.tmLanguage.json`);
      return parseRawGrammar(fs.readFileSync(file, "utf8"), file);
    },
  });
  for (const name of ["turtle", "bddl"]) {
    grammars[name] = await registry.loadGrammar(`source.${name}`);
  }
});

/** Each piece of a text with the innermost of its scopes that a theme colours. */
function pieces(name, text) {
  let state = INITIAL;
  const found = [];
  for (const line of text.split("\n")) {
    const read = grammars[name].tokenizeLine(line, state);
    state = read.ruleStack;
    for (const { startIndex, endIndex, scopes } of read.tokens) {
      found.push({ text: line.slice(startIndex, endIndex), scopes });
    }
  }
  return found;
}

/** The scopes of the piece that holds `wanted`, the `nth` of those (from 0), as one text. */
function scopesOf(name, text, wanted, nth = 0) {
  const found = pieces(name, text).filter((piece) => piece.text.includes(wanted))[nth];
  assert.ok(found, `${wanted} is no piece of ${JSON.stringify(pieces(name, text).map((piece) => piece.text))}`);
  return found.scopes.join(" ");
}

const turtle = (text, wanted, scope, nth) => assert.match(scopesOf("turtle", text, wanted, nth), new RegExp(scope));
const bddl = (text, wanted, scope, nth) => assert.match(scopesOf("bddl", text, wanted, nth), new RegExp(scope));

test("directives, names and IRIs of Turtle", () => {
  const text = "@prefix ex: <http://example.org/a#b> .\nPREFIX : <x>\nex:Löffel.2 a :b ; ex:p 1.5e3 , true .";
  turtle(text, "@prefix", "keyword.control.directive");
  turtle(text, "PREFIX", "keyword.control.directive");
  turtle(text, "http://example.org/a#b", "string.other.link.iri");
  turtle(text, "Löffel.2", "entity.name.tag.local");
  turtle(text, "a", "keyword.other.a", pieces("turtle", text).filter((p) => p.text.includes("a")).findIndex((p) => p.text === "a"));
  turtle(text, "1.5e3", "constant.numeric");
  turtle(text, "true", "constant.language.boolean");
});

test("a number sign in an IRI or a string begins no comment, and one elsewhere does", () => {
  const text = '<http://e/#x> <p> "a # b" . # said <of> "it"\n<s> <p> 1 .';
  turtle(text, "http://e/#x", "string.other.link.iri");
  turtle(text, "a # b", "string.quoted.double");
  turtle(text, "said <of>", "comment.line");
  turtle(text, "1", "constant.numeric");
});

test("a long string goes on over lines, with quotes and escapes inside", () => {
  for (const quote of ['"""', "'''"]) {
    const text = `ex:s ex:p ${quote}one "two" 'three' # four\n@prefix \\u0041 five\n${quote}@en ; ex:q 7 .`;
    for (const word of ["# four", "@prefix", "five"]) {
      turtle(text, word, "string.quoted.triple");
    }
    turtle(text, "\\u0041", "constant.character.escape");
    turtle(text, "@en", "storage.modifier.language");
    turtle(text, "7", "constant.numeric");
  }
});

test("a short string ends with its line", () => {
  const text = 'ex:s ex:p "open\nex:t ex:p 7 .';
  turtle(text, "open", "string.quoted.double");
  turtle(text, "7", "constant.numeric");
  assert.doesNotMatch(scopesOf("turtle", text, "7"), /string/);
});

test("triple terms, reified triples, reifiers, annotations and directions of Turtle 1.2", () => {
  const text = [
    "VERSION \"1.2\"",
    "ex:s ex:p <<( ex:a ex:b <<( ex:c ex:d 4 )>> )>> .",
    "<< ex:a ex:b 5 ~ ex:r >> ex:q ( 6 ) .",
    'ex:a ex:b "x"@ar--rtl ~ ex:t {| ex:since 8 |} .',
    "ex:z ex:p 9 .",
  ].join("\n");
  turtle(text, "VERSION", "keyword.control.directive");
  turtle(text, "4", "meta.triple-term.turtle meta.triple-term.turtle");
  turtle(text, "5", "meta.reified-triple");
  turtle(text, "~", "keyword.operator.reifier");
  turtle(text, "8", "meta.annotation");
  turtle(text, "--rtl", "storage.modifier.direction");
  assert.doesNotMatch(scopesOf("turtle", text, "6"), /triple|annotation/);
  assert.doesNotMatch(scopesOf("turtle", text, "9"), /triple|annotation/);
});

test("sections, declarations and atoms of BDDL", () => {
  const text = [
    "(define (problem P) ; a task",
    "  (:language Put the bowl",
    "    and the plate away)",
    "  (:objects",
    "    bowl_1 bowl_2 - bowl)",
    "  (:init (On bowl_1 table_region))",
    "  (:goal (And (forall (?x - bowl) (Not (In ?x drawer_1))))))",
  ].join("\n");
  bddl(text, "define", "keyword.operator.logical");
  bddl(text, "a task", "comment.line");
  bddl(text, "Put the bowl", "string.unquoted.instruction");
  bddl(text, "and the plate", "string.unquoted.instruction");
  bddl(text, ":objects", "keyword.control.section");
  bddl(text, "bowl_2", "entity.name.variable.instance");
  bddl(text, "bowl", "entity.name.type.category", pieces("bddl", text).filter((p) => p.text.includes("bowl")).findIndex((p) => p.text === "bowl"));
  bddl(text, "On", "entity.name.function");
  bddl(text, "table_region", "variable.other");
  bddl(text, "And", "keyword.operator.logical");
  bddl(text, "forall", "keyword.operator.logical");
  bddl(text, "?x", "variable.parameter");
  bddl(text, "In", "entity.name.function");
});

test("every Turtle and BDDL file of the examples is read to its end without an open string", () => {
  const examples = path.join(__dirname, "..", "..", "..", "docs", "examples");
  let read = 0;
  for (const [name, ending] of [["turtle", ".ttl"], ["bddl", ".bddl"]]) {
    for (const file of fs.readdirSync(examples).filter((one) => one.endsWith(ending))) {
      const text = fs.readFileSync(path.join(examples, file), "utf8").trimEnd();
      const last = pieces(name, text).filter((piece) => piece.text.trim()).at(-1);
      assert.doesNotMatch(last.scopes.join(" "), /string|comment|illegal/, file);
      assert.deepEqual(last.scopes.filter((scope) => scope.startsWith("meta.")), [], file);
      read += 1;
    }
  }
  assert.ok(read >= 2);
});
