// What the extension and its tests know of the server.
"use strict";

/** The arguments of `onto` that serve an editor; `ontology` are the Turtle files that task files are lifted by. */
exports.arguments_ = (ontology) => (ontology.length ? ["lsp", "--ontology", ...ontology] : ["lsp"]);

/** The files whose change outside of the editor may change what is found in an open one. */
exports.watched = ["**/*.ttl", "**/{pyproject,onto}.toml"];
