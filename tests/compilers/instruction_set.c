/* Prints which kernels run here. */
#include <holonomic.h>
#include <stdio.h>

int main(void)
{
    puts(hol_instruction_set());
    return 0;
}
