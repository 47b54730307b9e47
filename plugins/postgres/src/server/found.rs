//! The tables that a schema has.

use std::collections::HashMap;

use postgres::GenericClient;

/// What a schema has.
pub(super) struct Found {
    /// The columns by their names, of tables by theirs.
    pub(super) columns: HashMap<String, HashMap<String, FoundColumn>>,
    /// What is said of tables.
    pub(super) docs: HashMap<String, String>,
}

/// A column that a table has.
pub(super) struct FoundColumn {
    pub(super) kind: String,
    pub(super) doc: Option<String>,
}

impl Found {
    pub(super) fn read(client: &mut impl GenericClient, schema: &str) -> Result<Found, postgres::Error> {
        let question = "SELECT relname::text, obj_description(c.oid, 'pg_class'), attname::text, \
                        format_type(atttypid, atttypmod), col_description(c.oid, attnum) \
                        FROM pg_class c JOIN pg_namespace n ON n.oid = relnamespace \
                        JOIN pg_attribute a ON attrelid = c.oid AND attnum > 0 AND NOT attisdropped \
                        WHERE nspname = $1 AND relkind IN ('r', 'p', 'v', 'm', 'f')";
        let mut found = Found { columns: HashMap::new(), docs: HashMap::new() };
        for row in client.query(question, &[&schema])? {
            let (table, column): (String, String) = (row.get(0), row.get(2));
            if let Some(doc) = row.get(1) {
                found.docs.insert(table.clone(), doc);
            }
            let about = FoundColumn { kind: row.get(3), doc: row.get(4) };
            found.columns.entry(table).or_default().insert(column, about);
        }
        Ok(found)
    }
}
