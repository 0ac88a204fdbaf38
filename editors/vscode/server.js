// What the extension and its tests know of the server.
"use strict";

/** The arguments of `onto` that serve an editor; `ontology` are the Turtle files that task files are lifted by. */
exports.arguments_ = (ontology) => (ontology.length ? ["lsp", "--ontology", ...ontology] : ["lsp"]);
