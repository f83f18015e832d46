-- Rights on a server: a reader looks, an operator adds parts, an engineer also corrects and removes. Give them to people with
-- GRANT truepath_operator TO name. Needs CREATEROLE where the roles are not there yet; may be run again after a migration.
DO $roles$
BEGIN
    IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = 'truepath_reader') THEN CREATE ROLE truepath_reader NOLOGIN; END IF;
    IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = 'truepath_operator') THEN CREATE ROLE truepath_operator NOLOGIN; END IF;
    IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = 'truepath_engineer') THEN CREATE ROLE truepath_engineer NOLOGIN; END IF;
    EXECUTE format('GRANT USAGE ON SCHEMA %I TO truepath_reader', current_schema());
    EXECUTE format('GRANT SELECT ON ALL TABLES IN SCHEMA %I TO truepath_reader', current_schema());
    EXECUTE format('GRANT INSERT ON ALL TABLES IN SCHEMA %I TO truepath_operator', current_schema());
    EXECUTE format('GRANT UPDATE, DELETE ON ALL TABLES IN SCHEMA %I TO truepath_engineer', current_schema());
END
$roles$;
REVOKE INSERT ON schema_version FROM truepath_operator;
REVOKE UPDATE, DELETE ON schema_version, event FROM truepath_engineer;
GRANT truepath_reader TO truepath_operator;
GRANT truepath_operator TO truepath_engineer;
-- What storing a part changes beside the rows it adds.
GRANT UPDATE (value) ON counter TO truepath_operator;
GRANT UPDATE (cut_nm) ON cutter TO truepath_operator;
GRANT UPDATE (make) ON machine TO truepath_operator;
GRANT UPDATE (parent) ON correction TO truepath_operator;
GRANT UPDATE (serial, machine, holder, cutter, cutter_serial, material, temperature_c) ON part TO truepath_operator;
