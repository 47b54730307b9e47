//! The schema of a history in PostgreSQL: made, or found to be the one that is meant.

use std::collections::HashMap;

use postgres::{Client, GenericClient};

use super::found::{Found, FoundColumn};
use super::names::{literal, quoted};
use crate::problem::{Outcome, Problem, reason};
use crate::source::{Run, Source};
use crate::table::{Column, Table};

/// The table that says which history the schema has.
pub(super) const ORIGIN: &str = "copied_from";

/// The table that says how far each table was brought.
pub(super) const POSITIONS: &str = "copied";

/// What setting up needs to know.
pub(super) struct Wanted<'a> {
    pub(super) schema: &'a str,
    pub(super) database: &'a str,
    pub(super) source: &'a Source,
    pub(super) tables: &'a [Table],
    pub(super) runs: &'a [Run],
}

impl Wanted<'_> {
    /// Makes what is missing, in one transaction.
    pub(super) fn set_up(&self, client: &mut Client) -> Outcome<()> {
        let what = format!("the schema `{}` of {} cannot be prepared", self.schema, self.database);
        let failed = |error: &postgres::Error| Problem::of(&what, error);
        let mut transaction = client.transaction().map_err(|error| failed(&error))?;
        // Two programs that make the same tables at the same time would be in each other's way.
        let lock = "SELECT pg_advisory_xact_lock(hashtext('saoms-postgres'))";
        transaction.batch_execute(lock).map_err(|error| failed(&error))?;
        self.make_schema(&mut transaction)?;
        let found = Found::read(&mut transaction, self.schema).map_err(|error| failed(&error))?;
        let is_new = !found.columns.contains_key(ORIGIN);
        if is_new {
            self.refuse_others(&mut transaction, &what)?;
            self.make_own(&mut transaction).map_err(|error| failed(&error))?;
        } else {
            self.refuse_other_history(&mut transaction, &what)?;
        }
        for table in self.tables {
            if let Some(columns) = found.columns.get(&table.name) {
                self.refuse_other_types(table, columns)?;
            } else if !is_new {
                self.refuse_removed(&mut transaction, table, &what)?;
            }
            for statement in self.statements(table, &found) {
                transaction.batch_execute(&statement).map_err(|error| failed(&error))?;
            }
        }
        transaction.commit().map_err(|error| failed(&error))
    }

    fn make_schema(&self, client: &mut impl GenericClient) -> Outcome<()> {
        let (schema, database) = (self.schema, self.database);
        let known = client.query("SELECT 1 FROM pg_namespace WHERE nspname = $1", &[&schema]);
        let made = match known {
            Ok(rows) if !rows.is_empty() => return Ok(()),
            Ok(_) => client.batch_execute(&format!("CREATE SCHEMA {}", quoted(schema))),
            Err(error) => Err(error),
        };
        made.map_err(|error| {
            let what = format!("the schema `{schema}` cannot be made in {database}");
            match Problem::of(&what, &error) {
                Problem::Wrong(_) => Problem::Wrong(format!(
                    "{what}: {}; let who may do it execute `CREATE SCHEMA {} AUTHORIZATION user`, or name a schema of \
                     the user with `--schema`",
                    reason(&error),
                    quoted(schema)
                )),
                other => other,
            }
        })
    }

    fn refuse_others(&self, client: &mut impl GenericClient, what: &str) -> Outcome<()> {
        let question = "SELECT relname::text FROM pg_class JOIN pg_namespace n ON n.oid = relnamespace \
                        WHERE nspname = $1 AND relkind IN ('r', 'p', 'v', 'm', 'f') ORDER BY 1 LIMIT 1";
        let others = client.query(question, &[&self.schema]).map_err(|error| Problem::of(what, &error))?;
        let Some(other) = others.first() else { return Ok(()) };
        let other: String = other.get(0);
        Err(Problem::Wrong(format!(
            "the schema `{}` of {} has the table `{other}`, but no history: name another one with `--schema`, which is \
             made if it is missing",
            self.schema, self.database
        )))
    }

    fn refuse_other_history(&self, client: &mut impl GenericClient, what: &str) -> Outcome<()> {
        let schema = quoted(self.schema);
        let failed = |error: postgres::Error| Problem::of(what, &error);
        let known = client.query(&format!("SELECT history FROM {schema}.{ORIGIN}"), &[]).map_err(failed)?;
        let refused = |which: &str, or: &str| {
            Problem::Wrong(format!(
                "the schema `{}` of {} has {which} `{}`: {or}name another schema with `--schema`",
                self.schema,
                self.database,
                self.source.path.display()
            ))
        };
        if known.first().is_none_or(|row| row.get::<_, String>(0) != self.source.id) {
            return Err(refused("the history of another file than", ""));
        }
        let runs = format!("SELECT run, began FROM {schema}.runs ORDER BY run");
        let own: HashMap<i64, &str> = self.runs.iter().map(|run| (run.run, run.began.as_str())).collect();
        let mut other = client.query(&runs, &[]).map_err(failed)?.into_iter().filter(|row| {
            let began: String = row.get(1);
            own.get(&row.get::<_, i64>(0)).is_none_or(|own| *own != began)
        });
        other.next().map_or(Ok(()), |row| {
            let (run, began): (i64, String) = (row.get(0), row.get(1));
            Err(refused(
                &format!("run {run}, which began at {began} and is not in"),
                "the file is an earlier copy of that history, so name the file that has this run, or ",
            ))
        })
    }

    fn refuse_removed(&self, client: &mut impl GenericClient, table: &Table, what: &str) -> Outcome<()> {
        let question = format!("SELECT 1 FROM {}.{POSITIONS} WHERE table_name = $1 LIMIT 1", quoted(self.schema));
        let known = client.query(&question, &[&table.name]).map_err(|error| Problem::of(what, &error))?;
        if known.is_empty() {
            return Ok(());
        }
        Err(Problem::Wrong(format!(
            "the table `{}` of the schema `{}` of {} was removed, though rows of it were brought: drop the whole schema \
             to bring all again, or name another one with `--schema`",
            table.name, self.schema, self.database
        )))
    }

    fn refuse_other_types(&self, table: &Table, found: &HashMap<String, FoundColumn>) -> Outcome<()> {
        for column in &table.columns {
            let expected = column.kind.in_postgres();
            if let Some(other) = found.get(&column.name).filter(|found| found.kind != expected) {
                return Err(Problem::Wrong(format!(
                    "the column `{}` of the table `{}` in the schema `{}` of {} is of the type {}, expected {expected}: \
                     name another schema with `--schema`",
                    column.name, table.name, self.schema, self.database, other.kind
                )));
            }
        }
        Ok(())
    }

    fn make_own(&self, client: &mut impl GenericClient) -> Result<(), postgres::Error> {
        let schema = quoted(self.schema);
        client.batch_execute(&format!(
            "CREATE TABLE {schema}.{ORIGIN} (history text NOT NULL, batches bigint NOT NULL, at timestamptz NOT NULL);
             COMMENT ON TABLE {schema}.{ORIGIN} IS 'The history of SQLite that saoms-postgres brings here';
             COMMENT ON COLUMN {schema}.{ORIGIN}.history IS 'its id, as in the table history';
             COMMENT ON COLUMN {schema}.{ORIGIN}.batches IS 'number of transactions so far';
             COMMENT ON COLUMN {schema}.{ORIGIN}.at IS 'when the last one was';
             CREATE TABLE {schema}.{POSITIONS} (table_name text, run bigint, position bigint NOT NULL,
                 gaps text NOT NULL, PRIMARY KEY (table_name, run));
             COMMENT ON TABLE {schema}.{POSITIONS} IS 'How far saoms-postgres has brought each table';
             COMMENT ON COLUMN {schema}.{POSITIONS}.table_name IS 'the table';
             COMMENT ON COLUMN {schema}.{POSITIONS}.run IS 'the run; 0 where a table is not brought by runs';
             COMMENT ON COLUMN {schema}.{POSITIONS}.position IS
                 'the last record or row; of the table runs 1 if all of a run is here';
             COMMENT ON COLUMN {schema}.{POSITIONS}.gaps IS
                 'records before it that are not there yet, or were lost, as 17-17 101-105';"
        ))?;
        let origin = format!("INSERT INTO {schema}.{ORIGIN} VALUES ($1, 0, now())");
        client.execute(&origin, &[&self.source.id])?;
        Ok(())
    }

    /// What makes a table, columns and comments that are missing.
    fn statements(&self, table: &Table, found: &Found) -> Vec<String> {
        let name = format!("{}.{}", quoted(self.schema), quoted(&table.name));
        let none = HashMap::new();
        let known = found.columns.get(&table.name);
        let mut statements = Vec::new();
        if known.is_none() {
            let columns = table.columns.iter();
            let mut parts: Vec<String> =
                columns.map(|column| format!("{} {}", quoted(&column.name), column.kind.in_postgres())).collect();
            if !table.key.is_empty() {
                let key = table.key_names().map(quoted).collect::<Vec<_>>().join(", ");
                parts.push(format!("PRIMARY KEY ({key})"));
            }
            statements.push(format!("CREATE TABLE {name} ({})", parts.join(", ")));
            for (index, columns) in &table.indexes {
                let columns = columns.iter().map(|column| quoted(column)).collect::<Vec<_>>().join(", ");
                statements.push(format!("CREATE INDEX {} ON {name} ({columns})", quoted(index)));
            }
        } else {
            let missing = |column: &&Column| !known.unwrap_or(&none).contains_key(&column.name);
            for column in table.columns.iter().filter(missing) {
                let (column, kind) = (quoted(&column.name), column.kind.in_postgres());
                statements.push(format!("ALTER TABLE {name} ADD COLUMN {column} {kind}"));
            }
        }
        if !table.doc.is_empty() && found.docs.get(&table.name) != Some(&table.doc) {
            statements.push(format!("COMMENT ON TABLE {name} IS {}", literal(&table.doc)));
        }
        for column in table.columns.iter().filter(|column| !column.doc.is_empty()) {
            let doc = known.and_then(|known| known.get(&column.name)).and_then(|found| found.doc.as_ref());
            if doc != Some(&column.doc) {
                let column_name = quoted(&column.name);
                statements.push(format!("COMMENT ON COLUMN {name}.{column_name} IS {}", literal(&column.doc)));
            }
        }
        statements
    }
}
