//! Answers of the editor's functions in the types of the protocol.

use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionTextEdit, DocumentSymbol, Documentation, FoldingRange,
    FoldingRangeKind, InsertTextFormat, MarkupContent, MarkupKind, SymbolKind, TextEdit,
};
use saoms_tools::editor::{self, File, FileEdit, Fold, Proposal, ProposalKind};

use super::position::range_in;

pub(super) fn text_edit(file: &File, edit: FileEdit) -> TextEdit {
    TextEdit::new(range_in(file, edit.range), edit.text)
}

pub(super) fn completion_item(file: &File, one: Proposal, knows_snippets: bool) -> CompletionItem {
    let sort_text = Some(one.order());
    let (new_text, is_snippet) = one.insert.text(knows_snippets);
    let new_text = new_text.to_owned();
    let format = if is_snippet { InsertTextFormat::SNIPPET } else { InsertTextFormat::PLAIN_TEXT };
    // Editors compare the typed text with this one, or else with the label.
    let filter_text = new_text.starts_with('<').then(|| format!("<{}", one.label));
    let documentation = (!one.doc.is_empty()).then_some(MarkupContent { kind: MarkupKind::Markdown, value: one.doc });
    CompletionItem {
        sort_text,
        label: one.label,
        kind: Some(completion_kind(one.kind)),
        detail: (!one.detail.is_empty()).then_some(one.detail),
        documentation: documentation.map(Documentation::MarkupContent),
        filter_text,
        insert_text_format: Some(format),
        additional_text_edits: one.also.map(|edit| vec![text_edit(file, edit)]),
        text_edit: Some(CompletionTextEdit::Edit(TextEdit { range: range_in(file, one.range), new_text })),
        ..CompletionItem::default()
    }
}

fn completion_kind(kind: ProposalKind) -> CompletionItemKind {
    match kind {
        ProposalKind::Class => CompletionItemKind::CLASS,
        ProposalKind::Constant => CompletionItemKind::CONSTANT,
        ProposalKind::EnumMember => CompletionItemKind::ENUM_MEMBER,
        ProposalKind::Event => CompletionItemKind::EVENT,
        ProposalKind::Field => CompletionItemKind::FIELD,
        ProposalKind::File => CompletionItemKind::FILE,
        ProposalKind::Folder => CompletionItemKind::FOLDER,
        ProposalKind::Function => CompletionItemKind::FUNCTION,
        ProposalKind::Interface => CompletionItemKind::INTERFACE,
        ProposalKind::Keyword => CompletionItemKind::KEYWORD,
        ProposalKind::Module => CompletionItemKind::MODULE,
        ProposalKind::Property => CompletionItemKind::PROPERTY,
        ProposalKind::TypeParameter => CompletionItemKind::TYPE_PARAMETER,
        ProposalKind::Value => CompletionItemKind::VALUE,
        ProposalKind::Variable => CompletionItemKind::VARIABLE,
    }
}

#[expect(deprecated, reason = "the field has to be given, and nothing is deprecated here")]
pub(super) fn document_symbol(file: &File, one: editor::DocumentSymbol) -> DocumentSymbol {
    let children: Vec<_> = one.children.into_iter().map(|child| document_symbol(file, child)).collect();
    DocumentSymbol {
        // A name must not be empty.
        name: if one.name.is_empty() { "?".to_owned() } else { one.name },
        detail: (!one.detail.is_empty()).then_some(one.detail),
        kind: symbol_kind(one.kind),
        tags: None,
        deprecated: None,
        range: range_in(file, one.range),
        selection_range: range_in(file, one.name_range),
        children: (!children.is_empty()).then_some(children),
    }
}

pub(super) fn symbol_kind(kind: editor::SymbolKind) -> SymbolKind {
    match kind {
        editor::SymbolKind::Composite => SymbolKind::MODULE,
        editor::SymbolKind::Component => SymbolKind::CLASS,
        editor::SymbolKind::Property => SymbolKind::PROPERTY,
        editor::SymbolKind::Service => SymbolKind::INTERFACE,
        editor::SymbolKind::Reference => SymbolKind::EVENT,
        editor::SymbolKind::Loop => SymbolKind::FUNCTION,
    }
}

pub(super) fn folding_range(fold: Fold) -> FoldingRange {
    FoldingRange {
        start_line: fold.start as u32,
        end_line: fold.end as u32,
        kind: fold.is_comment.then_some(FoldingRangeKind::Comment),
        ..FoldingRange::default()
    }
}
