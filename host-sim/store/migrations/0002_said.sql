-- What the points of an estimate say by themselves, whatever was believed before (JSON; see docs/store.md), and the make of a machine, as
-- alike as the shop thinks: from these the machines and materials of other jobs are expected.
ALTER TABLE machine ADD COLUMN make TEXT;
ALTER TABLE estimate ADD COLUMN said TEXT;
CREATE INDEX estimate_of_history ON estimate (history);
