// Starts `saoms lsp` for composites.

const { commands, window, workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

// What the command line of the server is, by the settings.
function commandLine(settings) {
  const plugins = settings.get("plugins", []).flatMap((path) => ["--plugin", path]);
  const assume = settings.get("assumeClasses", false) ? ["--assume-classes"] : [];
  return { command: settings.get("path", "saoms"), args: ["lsp", ...plugins, ...assume] };
}

async function start() {
  const folder = workspace.workspaceFolders?.[0]?.uri.fsPath;
  const server = { ...commandLine(workspace.getConfiguration("saoms")), options: { cwd: folder } };
  client = new LanguageClient("saoms", "SAOMS", server, {
    documentSelector: [
      ...["file", "untitled"].map((scheme) => ({ scheme, language: "saoms" })),
      // Tables and scenarios beside composites; the server has nothing to say about others.
      { scheme: "file", pattern: "**/*.{csv,txt}" },
    ],
  });
  try {
    await client.start();
  } catch (error) {
    window.showErrorMessage(
      `\`${server.command} lsp\` cannot be started: ${error instanceof Error ? error.message : error}. The setting \`saoms.path\` says where the program is.`,
    );
  }
}

async function stop() {
  const running = client;
  client = undefined;
  await running?.stop().catch(() => {});
}

async function restart() {
  await stop();
  await start();
}

exports.activate = async (context) => {
  context.subscriptions.push(
    commands.registerCommand("saoms.restart", restart),
    workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("saoms")) {
        restart();
      }
    }),
  );
  await start();
};

exports.deactivate = stop;
exports.commandLine = commandLine;
