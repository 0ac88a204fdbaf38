// Starts `onto lsp` for Turtle and BDDL, and starts it again when its settings change.
"use strict";

const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");
const { arguments_ } = require("./server.js");

let client;

async function start() {
  const settings = vscode.workspace.getConfiguration("onto");
  const command = settings.get("command");
  const folder = vscode.workspace.workspaceFolders?.[0]?.uri.fsPath;
  const run = { command, args: arguments_(settings.get("ontology")), options: { cwd: folder } };
  client = new LanguageClient("onto", "Onto", { run, debug: run }, {
    documentSelector: [{ scheme: "file", language: "turtle" }, { scheme: "file", language: "bddl" }],
  });
  try {
    await client.start();
  } catch (error) {
    const hint = `\`${command} lsp\` does not start: pip install "onto-evwm[lsp]", or set onto.command to its whole path.`;
    const chosen = await vscode.window.showErrorMessage(`${hint} (${error.message ?? error})`, "Open settings");
    if (chosen) {
      await vscode.commands.executeCommand("workbench.action.openSettings", "onto.command");
    }
  }
}

async function stop() {
  const running = client;
  client = undefined;
  if (running?.isRunning()) {
    await running.stop();
  }
}

async function restart() {
  await stop();
  await start();
}

exports.activate = async (context) => {
  context.subscriptions.push(
    vscode.commands.registerCommand("onto.restart", restart),
    vscode.workspace.onDidChangeConfiguration((event) => event.affectsConfiguration("onto") && restart()),
  );
  await start();
};

exports.deactivate = stop;
