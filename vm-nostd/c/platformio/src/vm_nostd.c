/* PlatformIO and Arduino build sources; the library itself is an archive. This one says if they do not belong
   together: it does not link with a library without the function. */

#include "vm_nostd.h"

int vm_header_fits(void);

int vm_header_fits(void) { return vm_version() == VM_VERSION; }
