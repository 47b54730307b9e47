// Starts `saoms lsp` for composites.

const { SnippetString, commands, window, workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

// What the command line of the server is, by the settings.
function commandLine(settings) {
  const plugins = settings.get("plugins", []).flatMap((path) => ["--plugin", path]);
  const assume = settings.get("assumeClasses", false) ? ["--assume-classes"] : [];
  const outside = settings.get("allowOutside", false) ? ["--allow-outside"] : [];
  return { command: settings.get("path", "saoms"), args: ["lsp", ...plugins, ...assume, ...outside] };
}

// Proposes at once what a proposal that was taken leaves open, as the class in `<implementation.rust class="..."/>`.
async function propose(document, position, context, token, next) {
  const found = await next(document, position, context, token);
  const items = Array.isArray(found) ? found : (found?.items ?? []);
  for (const item of items.filter((one) => one.insertText instanceof SnippetString)) {
    item.command = { title: "Propose", command: "editor.action.triggerSuggest", arguments: [{ auto: true }] };
  }
  return found;
}

// Says why the server cannot be started, and leads to the setting that mends it.
async function complain(command, error) {
  const settings = "Open settings";
  const why = error instanceof Error ? error.message : error;
  const text = `\`${command} lsp\` cannot be started: ${why}. The setting \`saoms.path\` says where the program is.`;
  if ((await window.showErrorMessage(text, settings)) === settings) {
    await commands.executeCommand("workbench.action.openSettings", "saoms.path");
  }
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
    middleware: { provideCompletionItem: propose },
  });
  try {
    await client.start();
  } catch (error) {
    complain(server.command, error);
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
