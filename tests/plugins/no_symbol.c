/* A library like any other: it exports nothing that we know. */
int armwright_plugin_is_not_this(void) {
  return 1;
}
