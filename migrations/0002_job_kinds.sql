-- What a job's document asks for, as its own "kind" says: 'render' or 'study'.

ALTER TABLE jobs ADD COLUMN kind TEXT NOT NULL DEFAULT 'render';
