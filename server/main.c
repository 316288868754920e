/* main.c - delaunayd: reads the command line and runs the daemon. */
#include "server/config.h"
#include "server/daemon.h"
#include "server/machine.h"
#include "server/recover.h"

int main(int argc, char **argv)
{
    struct config config;
    machine_raise_descriptors(); /* first: the default of --max-clients depends on it */
    config_init(&config);
    switch (config_parse(&config, argc, argv)) {
    case CONFIG_EXIT:
        return 0;
    case CONFIG_BAD:
        return 2;
    case CONFIG_RUN:
        break;
    }
    if (config.check != NULL)
        return recovery_check(config.check);
    if (config.repair != NULL)
        return recovery_repair(config.repair);
    return daemon_run(&config);
}
