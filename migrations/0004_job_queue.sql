-- Who goes first: a priority that the job's document names, and the client whose turn it is.

ALTER TABLE jobs ADD COLUMN priority INTEGER NOT NULL DEFAULT 5 CHECK (priority BETWEEN 0 AND 9);
ALTER TABLE jobs ADD COLUMN client TEXT NOT NULL DEFAULT '';
