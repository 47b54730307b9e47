//! The questions that an editor can ask, in the terms of the protocol.

use std::collections::{BTreeMap, HashMap};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use lsp_server::ErrorCode;
use lsp_types::request::{self as ask, Request};
use lsp_types::{
    CompletionList, CompletionParams, CompletionResponse, DocumentFormattingParams, DocumentHighlight,
    DocumentHighlightParams, DocumentLink, DocumentLinkParams, DocumentSymbolParams, DocumentSymbolResponse,
    FoldingRange, FoldingRangeParams, GotoDefinitionParams, GotoDefinitionResponse, Hover, HoverContents, HoverParams,
    LinkedEditingRangeParams, LinkedEditingRanges, Location, MarkupContent, MarkupKind, Position,
    PrepareRenameResponse, ReferenceParams, RenameParams, SelectionRange, SelectionRangeParams, SymbolInformation,
    TextDocumentPositionParams, TextEdit, Uri, WorkspaceEdit, WorkspaceSymbolResponse,
};
use saoms_tools::editor::{
    DefinitionTarget, FileRange, Proposal, Scene, complete, definition, document_symbols, folds, formatted, hover,
    linked_tags, links, prepare_rename, references, rename, selections, workspace_symbols,
};
use serde_json::Value;
use serde_json::value::RawValue;

use super::convert::{completion_item, document_symbol, folding_range, symbol_kind};
use super::position::{offset_in, range_in};
use super::server::{Refusal, Server, written};
use super::uri;

/// So many proposals can be looked through; of thousands of components those come that fit what is typed.
const MOST: usize = 300;

impl<W: Write> Server<W> {
    /// The answer to a question.
    pub(super) fn answer(&mut self, method: &str, params: Value) -> Result<Box<RawValue>, Refusal> {
        match method {
            ask::Completion::METHOD => answered::<ask::Completion>(params, |params| self.completion(params)),
            ask::HoverRequest::METHOD => answered::<ask::HoverRequest>(params, |params| self.hover(&params)),
            ask::GotoDefinition::METHOD => answered::<ask::GotoDefinition>(params, |params| self.definition(&params)),
            ask::References::METHOD => answered::<ask::References>(params, |params| self.references(&params)),
            ask::DocumentHighlightRequest::METHOD => {
                answered::<ask::DocumentHighlightRequest>(params, |params| self.highlights(&params))
            }
            ask::PrepareRenameRequest::METHOD => {
                answered::<ask::PrepareRenameRequest>(params, |params| self.prepare_rename(&params))
            }
            ask::Rename::METHOD => answered::<ask::Rename>(params, |params| self.rename(&params)),
            ask::DocumentSymbolRequest::METHOD => {
                answered::<ask::DocumentSymbolRequest>(params, |params| self.symbols(&params))
            }
            ask::WorkspaceSymbolRequest::METHOD => {
                answered::<ask::WorkspaceSymbolRequest>(params, |params| Ok(self.found(&params.query)))
            }
            ask::LinkedEditingRange::METHOD => {
                answered::<ask::LinkedEditingRange>(params, |params| self.linked(&params))
            }
            ask::CodeActionRequest::METHOD => {
                answered::<ask::CodeActionRequest>(params, |params| self.fixes(&params).map(Some))
            }
            ask::FoldingRangeRequest::METHOD => {
                answered::<ask::FoldingRangeRequest>(params, |params| self.folds(&params))
            }
            ask::SelectionRangeRequest::METHOD => {
                answered::<ask::SelectionRangeRequest>(params, |params| self.selections(&params))
            }
            ask::DocumentLinkRequest::METHOD => {
                answered::<ask::DocumentLinkRequest>(params, |params| self.links(&params))
            }
            ask::Formatting::METHOD => answered::<ask::Formatting>(params, |params| self.formatting(&params)),
            _ => Err(Refusal(ErrorCode::MethodNotFound, format!("`{method}` is not known"))),
        }
    }

    /// The scene of a document and the byte of a place in it.
    fn place(&mut self, at: &TextDocumentPositionParams) -> Result<(Scene, usize), Refusal> {
        let scene = self.scene(&at.text_document.uri)?;
        let byte = offset_in(scene.file(), at.position);
        Ok((scene, byte))
    }

    fn completion(&mut self, params: CompletionParams) -> Result<Option<CompletionResponse>, Refusal> {
        let (scene, byte) = self.place(&params.text_document_position)?;
        let knows_snippets = self.client.knows_snippets;
        let file = scene.file();
        let matching = |one: Proposal| {
            let typed = &file.text[one.range.start..byte];
            one.matching(typed)
        };
        let mut found: Vec<Proposal> = complete(&scene, byte).into_iter().filter_map(matching).collect();
        found.sort_by_cached_key(Proposal::order);
        let items = found.into_iter().take(MOST).map(|one| completion_item(file, one, knows_snippets));
        // Others come when more is typed, as the units behind a number do.
        let list = CompletionList { is_incomplete: true, items: items.collect() };
        Ok(Some(CompletionResponse::List(list)))
    }

    fn hover(&mut self, params: &HoverParams) -> Result<Option<Hover>, Refusal> {
        let at = &params.text_document_position_params;
        let (scene, byte) = self.place(at)?;
        let known = hover(&scene, byte);
        let mut parts: Vec<String> = self.reported_at(&at.text_document.uri, at.position);
        let range = known.as_ref().map(|(_, range)| range_in(scene.file(), range.clone()));
        parts.extend(known.map(|(text, _)| text));
        let contents = MarkupContent { kind: MarkupKind::Markdown, value: parts.join("\n\n---\n\n") };
        Ok((!parts.is_empty()).then_some(Hover { contents: HoverContents::Markup(contents), range }))
    }

    fn definition(&mut self, params: &GotoDefinitionParams) -> Result<Option<GotoDefinitionResponse>, Refusal> {
        let (scene, byte) = self.place(&params.text_document_position_params)?;
        let all = definition(&scene, byte).into_iter().filter_map(|target| match target {
            DefinitionTarget::Range(place) => {
                Some(Location { uri: self.uri_in(&scene, place.file)?, range: range(&scene, &place) })
            }
            DefinitionTarget::File(path) => {
                let uri = Uri::from_str(&uri::uri(&path)).ok()?;
                Some(Location { uri, range: lsp_types::Range::default() })
            }
        });
        Ok(Some(GotoDefinitionResponse::Array(all.collect())))
    }

    fn references(&mut self, params: &ReferenceParams) -> Result<Option<Vec<Location>>, Refusal> {
        let (scene, byte) = self.place(&params.text_document_position)?;
        let found = references(&scene, byte, params.context.include_declaration);
        let mut uris: HashMap<usize, Option<Uri>> = HashMap::new();
        let location = |place: &FileRange| {
            let uri = uris.entry(place.file).or_insert_with(|| self.uri_in(&scene, place.file));
            Some(Location { uri: uri.clone()?, range: range(&scene, place) })
        };
        Ok(Some(found.iter().filter_map(location).collect()))
    }

    fn highlights(&mut self, params: &DocumentHighlightParams) -> Result<Option<Vec<DocumentHighlight>>, Refusal> {
        let (scene, byte) = self.place(&params.text_document_position_params)?;
        let here = references(&scene, byte, true).into_iter().filter(|place| place.file == 0);
        Ok(Some(here.map(|place| DocumentHighlight { range: range(&scene, &place), kind: None }).collect()))
    }

    fn prepare_rename(
        &mut self,
        params: &TextDocumentPositionParams,
    ) -> Result<Option<PrepareRenameResponse>, Refusal> {
        let (scene, byte) = self.place(params)?;
        let place = prepare_rename(&scene, byte).map_err(|why| Refusal(ErrorCode::RequestFailed, why))?;
        Ok(Some(PrepareRenameResponse::Range(range(&scene, &place))))
    }

    fn rename(&mut self, params: &RenameParams) -> Result<Option<WorkspaceEdit>, Refusal> {
        let (scene, byte) = self.place(&params.text_document_position)?;
        let edits = rename(&scene, byte, &params.new_name);
        let edits = edits.map_err(|why| Refusal(ErrorCode::RequestFailed, why))?;
        let mut files: BTreeMap<usize, Vec<TextEdit>> = BTreeMap::new();
        for (place, new) in edits {
            files.entry(place.file).or_default().push(TextEdit::new(range(&scene, &place), new));
        }
        let changes = files.into_iter().filter_map(|(file, edits)| Some((self.uri_in(&scene, file)?, edits)));
        Ok(Some(WorkspaceEdit { changes: Some(changes.collect()), ..WorkspaceEdit::default() }))
    }

    fn symbols(&mut self, params: &DocumentSymbolParams) -> Result<Option<DocumentSymbolResponse>, Refusal> {
        let scene = self.scene(&params.text_document.uri)?;
        let file = scene.file();
        let all = document_symbols(file).into_iter().map(|one| document_symbol(file, one)).collect();
        Ok(Some(DocumentSymbolResponse::Nested(all)))
    }

    /// The composites and components of all files by their names.
    #[expect(deprecated, reason = "the field has to be given, and nothing is deprecated here")]
    fn found(&mut self, query: &str) -> Option<WorkspaceSymbolResponse> {
        let open: Vec<PathBuf> = self.documents.iter().map(|(_, one)| one.path.clone()).collect();
        let files = self.workspace.all(&self.client.folders, &open);
        let all = workspace_symbols(&files, query).into_iter().filter_map(|one| {
            let uri = Uri::from_str(&self.uri_of(&one.file.path)).ok()?;
            let location = Location { uri, range: range_in(one.file, one.start..one.end) };
            let container_name = (!one.container.is_empty()).then(|| one.container.to_owned());
            Some(SymbolInformation {
                name: one.name.to_owned(),
                kind: symbol_kind(one.kind),
                tags: None,
                deprecated: None,
                location,
                container_name,
            })
        });
        Some(WorkspaceSymbolResponse::Flat(all.take(MOST).collect()))
    }

    /// The names of both tags of an element, which are typed as one.
    fn linked(&mut self, params: &LinkedEditingRangeParams) -> Result<Option<LinkedEditingRanges>, Refusal> {
        let (scene, byte) = self.place(&params.text_document_position_params)?;
        let file = scene.file();
        let both = linked_tags(file, byte).map(|both| both.map(|at| range_in(file, at)).into());
        Ok(both.map(|ranges| LinkedEditingRanges { ranges, word_pattern: None }))
    }

    fn folds(&mut self, params: &FoldingRangeParams) -> Result<Option<Vec<FoldingRange>>, Refusal> {
        let scene = self.scene(&params.text_document.uri)?;
        Ok(Some(folds(scene.file()).into_iter().map(folding_range).collect()))
    }

    fn selections(&mut self, params: &SelectionRangeParams) -> Result<Option<Vec<SelectionRange>>, Refusal> {
        let scene = self.scene(&params.text_document.uri)?;
        let file = scene.file();
        let one = |place: &Position| {
            let around = selections(file, offset_in(file, *place));
            let widest_first = around.into_iter().rev();
            let nested = widest_first.fold(None, |parent, range| {
                let range = range_in(file, range);
                Some(SelectionRange { range, parent: parent.map(Box::new) })
            });
            let nothing = || SelectionRange { range: lsp_types::Range::new(*place, *place), parent: None };
            nested.unwrap_or_else(nothing)
        };
        Ok(Some(params.positions.iter().map(one).collect()))
    }

    fn links(&mut self, params: &DocumentLinkParams) -> Result<Option<Vec<DocumentLink>>, Refusal> {
        let scene = self.scene(&params.text_document.uri)?;
        let file = scene.file();
        let all = links(&scene).into_iter().filter_map(|(at, path)| {
            let target = Some(Uri::from_str(&self.uri_of(&path)).ok()?);
            let range = range_in(file, at);
            Some(DocumentLink { range, target, tooltip: None, data: None })
        });
        Ok(Some(all.collect()))
    }

    /// The layout of `saoms fmt`; a text that is not well-formed stays as it is.
    fn formatting(&mut self, params: &DocumentFormattingParams) -> Result<Option<Vec<TextEdit>>, Refusal> {
        let scene = self.scene(&params.text_document.uri)?;
        let file = scene.file();
        let Some(formatted) = formatted(file) else { return Ok(None) };
        if formatted == *file.text {
            return Ok(Some(Vec::new()));
        }
        let whole = range_in(file, 0..file.text.len());
        Ok(Some(vec![TextEdit::new(whole, formatted)]))
    }

    /// The URI of a file of a scene.
    fn uri_in(&self, scene: &Scene, file: usize) -> Option<Uri> {
        Uri::from_str(&self.uri_of(&scene.files[file].path)).ok()
    }

    /// The URI of a file: that of the editor where it is open.
    pub(super) fn uri_of(&self, path: &Path) -> String {
        self.documents.uri(path).map_or_else(|| uri::uri(path), str::to_owned)
    }
}

fn range(scene: &Scene, place: &FileRange) -> lsp_types::Range {
    range_in(&scene.files[place.file], place.range())
}

/// Reads the parameters of a question, asks it, and writes its answer.
fn answered<R: Request>(
    params: Value,
    ask: impl FnOnce(R::Params) -> Result<R::Result, Refusal>,
) -> Result<Box<RawValue>, Refusal> {
    let params = serde_json::from_value(params)
        .map_err(|error| Refusal(ErrorCode::InvalidParams, format!("the parameters are wrong: {error}")))?;
    written(&ask(params)?)
}
