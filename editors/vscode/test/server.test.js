// The server as the extension starts it, over standard input and output. ONTO names the program, if `onto` does not.
"use strict";

const assert = require("node:assert/strict");
const { spawn } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { test } = require("node:test");
const { pathToFileURL } = require("node:url");
const rpc = require("vscode-languageserver-protocol/node");
const { arguments_ } = require("../server.js");

const EXAMPLES = path.join(__dirname, "..", "..", "..", "docs", "examples");

test("the client opens a task, and the server answers as it said it would", { timeout: 60_000 }, async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "onto-"));
  for (const file of ["served.ttl", "serve_the_cheese.bddl"]) {
    fs.copyFileSync(path.join(EXAMPLES, file), path.join(folder, file));
  }
  const file = path.join(folder, "serve_the_cheese.bddl");
  const uri = pathToFileURL(file).href;
  const text = fs.readFileSync(file, "utf8").replace("(Served", "(Srved");

  const server = spawn(process.env.ONTO || "onto", arguments_([]), { cwd: folder, stdio: ["pipe", "pipe", "inherit"] });
  const ended = new Promise((resolve) => server.on("exit", resolve));
  const connection = rpc.createProtocolConnection(
    new rpc.StreamMessageReader(server.stdout),
    new rpc.StreamMessageWriter(server.stdin),
  );
  connection.listen();
  const { capabilities } = await connection.sendRequest(rpc.InitializeRequest.type, {
    processId: process.pid,
    rootUri: null,
    capabilities: {},
    workspaceFolders: [{ uri: pathToFileURL(folder).href, name: "folder" }],
  });
  for (const ability of ["codeAction", "definition", "documentSymbol", "references", "rename", "semanticTokens", "workspaceSymbol"]) {
    assert.ok(capabilities[`${ability}Provider`], ability);
  }
  await connection.sendNotification(rpc.InitializedNotification.type, {});

  const published = new Promise((resolve) =>
    connection.onNotification(rpc.PublishDiagnosticsNotification.type, (params) => params.uri === uri && resolve(params)),
  );
  const textDocument = { uri, languageId: "bddl", version: 1, text };
  await connection.sendNotification(rpc.DidOpenTextDocumentNotification.type, { textDocument });
  const { diagnostics } = await published;
  const wrong = diagnostics.find((one) => one.code === "BDDL003");
  assert.match(wrong.message, /did you mean `Served`/, "the ontology beside the task is read");
  assert.ok(wrong.codeDescription.href.endsWith("BDDL003.md"));

  const symbols = await connection.sendRequest(rpc.DocumentSymbolRequest.type, { textDocument: { uri } });
  assert.deepEqual(symbols.map((one) => one.name), ["Regions", "Fixtures", "Objects", "Initial facts", "Goal"]);

  await connection.sendRequest(rpc.ShutdownRequest.type);
  await connection.sendNotification(rpc.ExitNotification.type);
  assert.equal(await ended, 0);
  connection.dispose();
  fs.rmSync(folder, { recursive: true });
});
